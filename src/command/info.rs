//! stub
use crate::cli::InfoArgs;
/// Runs it.
pub fn run(_args: &InfoArgs) -> anyhow::Result<()> {
    anyhow::bail!("not yet")
}
