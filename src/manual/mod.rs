//! What every word of the language means, as text for people: `grammar/REFERENCE.md` ([`page`]), and what the language server
//! shows of a word under the pointer ([`signature`], [`words`]).
//!
//! The meanings themselves stand in the tables of [`turtle`](crate::turtle) and [`library`](crate::library), where the
//! program uses them; here they are only put into sentences and tables. Only words that belong to the syntax have their
//! meaning here.

pub mod page;
pub mod signature;
pub mod words;
