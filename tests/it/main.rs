//! What crosses folders, one module a theme.
