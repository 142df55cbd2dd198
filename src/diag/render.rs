//! (to be written by the syntax helper: ariadne reports)
