//! stub
use crate::cli::TrainArgs;
/// Runs it.
pub fn run(_args: TrainArgs) -> anyhow::Result<()> {
    anyhow::bail!("not yet")
}
