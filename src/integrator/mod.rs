//! (to be written)

pub mod cancel;

pub use cancel::CancelToken;
