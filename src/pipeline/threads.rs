//! The threads that work on a model.

use super::failure::Failure;
use crate::options::Options;
use rayon::ThreadPool;

/// Stack of each thread: deep recursion in a model ends by the language's own limit, long before this.
pub const STACK: usize = 64 << 20;

/// As many threads as the options ask for.
///
/// # Errors
/// If there are no such threads.
pub fn pool(options: &Options) -> Result<ThreadPool, Failure> {
    let n_threads = options.threads.value.map_or(0, |threads| threads.0.get());
    // A model runs on a thread of its own with a deep stack, outside the pool below; what it does in parallel uses the
    // global one. Only the first call in a process can set that, which does no harm.
    rayon::ThreadPoolBuilder::new()
        .num_threads(n_threads)
        .build_global()
        .ok();
    rayon::ThreadPoolBuilder::new()
        .num_threads(n_threads)
        .stack_size(STACK)
        .build()
        .map_err(|error| Failure::World(format!("cannot start {n_threads} threads: {error}")))
}
