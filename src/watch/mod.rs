//! Running a model again whenever it changes, and showing it on a page.
//!
//! One thread owns the state ([`desk::Desk`]) and reads [`Event`]s; a second one runs the model; a third one serves the
//! page. What counts is content: events of the file system only say when to look, and a look once a second finds what they
//! missed (network folders, replaced folders). A change while a run is under way cancels that run.
//!
//! ```text
//! files    events of the file system      session  the loop: events in, runs out    desk      when to look, what to do
//! snapshot what the inputs contain        live     from files and wishes to scenes   showing   pictures, better and better
//! pace     how large a draft may be
//! wish     what the page asks for         room     where threads meet               state     what the page shows
//! problems what is wrong, for the page    telling  who hears of progress            page      the server and the page
//! editor   opening a line in an editor     command  the command that makes the picture
//! ```

pub mod command;
pub mod desk;
mod early;
pub mod editor;
pub mod files;
pub mod live;
pub mod pace;
pub mod page;
pub mod problems;
pub mod room;
pub mod session;
mod showing;
pub mod snapshot;
pub mod state;
pub mod telling;
pub mod wish;

pub use session::{Event, Runner, Watched, watch};
