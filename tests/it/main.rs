//! What crosses folders, one module a theme.

mod align;
mod damage;
mod data;
mod info;
mod opening;
