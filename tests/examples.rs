//! Every example is free of errors, grows, and makes a picture of something.

use std::path::PathBuf;
use std::sync::Arc;
use std::sync::atomic::AtomicBool;
