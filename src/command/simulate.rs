//! stub
use crate::cli::SimulateArgs;
/// Runs it.
pub fn run(_args: &SimulateArgs) -> anyhow::Result<()> {
    anyhow::bail!("not yet")
}
