//! stub
use crate::cli::ViewArgs;
/// Runs it.
pub fn run(_args: ViewArgs) -> anyhow::Result<()> {
    anyhow::bail!("not yet")
}
