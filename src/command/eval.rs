//! stub
use crate::cli::EvalArgs;
/// Runs it.
pub fn run(_args: &EvalArgs) -> anyhow::Result<()> {
    anyhow::bail!("not yet")
}
