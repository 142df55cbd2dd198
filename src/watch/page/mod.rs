//! The page of watch mode: a server for this machine alone, and what it serves.
//!
//! ```text
//! GET  /            the page, with /style.css /page.js /orbit.js /panel.js /icon.svg
//! GET  /events      the state, whenever it changes (server-sent events)
//! GET  /frame/N     a picture that the state named
//! GET  /picture.png the last whole picture, to be saved
//! POST /wish        asks for another view, step, renderer, constant …
//! POST /write       writes changed constants into the model's files
//! POST /open        opens a place in the user's editor
//! ```
//! The page is in the program, as it was written. It loads nothing from anywhere else, and names no folder of the machine.

mod guard;

use super::room::{File, Room};
use super::wish::Wish;
use axum::Router;
use axum::body::Body;
use axum::extract::{DefaultBodyLimit, Json, Path, Request, State};
use axum::http::{HeaderName, HeaderValue, StatusCode, header};
use axum::middleware::{self, Next};
use axum::response::sse::{Event, KeepAlive, Sse};
use axum::response::{IntoResponse, Response};
use axum::routing::{get, post};
use futures_util::stream::{self, Stream};
use serde::Deserialize;
use std::convert::Infallible;
use std::io;
use std::net::{Ipv4Addr, SocketAddr, TcpListener};
use std::sync::Arc;
use std::time::Duration;

/// The port that is tried first.
pub const PORT: u16 = 7300;
/// Ports after it that are tried before any free one is taken.
const NEXT_PORTS: u16 = 20;
/// Bytes that a request may hold.
const LARGEST_REQUEST: usize = 64 << 10;
/// How long visitors may take to leave.
const FAREWELL: Duration = Duration::from_millis(300);

/// What the page is made of: path, kind and content.
const ASSETS: [(&str, &str, &str); 6] = [
    ("/", "text/html; charset=utf-8", include_str!("index.html")),
    (
        "/style.css",
        "text/css; charset=utf-8",
        include_str!("style.css"),
    ),
    (
        "/page.js",
        "text/javascript; charset=utf-8",
        include_str!("page.js"),
    ),
    (
        "/orbit.js",
        "text/javascript; charset=utf-8",
        include_str!("orbit.js"),
    ),
    (
        "/panel.js",
        "text/javascript; charset=utf-8",
        include_str!("panel.js"),
    ),
    ("/icon.svg", "image/svg+xml", include_str!("icon.svg")),
];

/// What browsers are told to refuse on the page.
const HEADERS: [(HeaderName, &str); 6] = [
    (
        header::CONTENT_SECURITY_POLICY,
        "default-src 'none'; script-src 'self'; style-src 'self'; img-src 'self' blob:; connect-src 'self'; \
         base-uri 'none'; form-action 'none'; frame-ancestors 'none'",
    ),
    (header::X_CONTENT_TYPE_OPTIONS, "nosniff"),
    (header::REFERRER_POLICY, "no-referrer"),
    (header::CACHE_CONTROL, "no-store"),
    (
        HeaderName::from_static("cross-origin-resource-policy"),
        "same-origin",
    ),
    (
        HeaderName::from_static("cross-origin-opener-policy"),
        "same-origin",
    ),
];

/// What the page may ask for besides pictures.
pub trait Service: Send + Sync {
    /// Refuses a wish that cannot be.
    ///
    /// # Errors
    /// Why, for people.
    fn check(&self, wish: &Wish) -> Result<(), String>;

    /// Writes the constants of a wish into the files they stand in; tells what was written.
    ///
    /// # Errors
    /// Why not, for people, without any path.
    fn write(&self, wish: &Wish) -> Result<String, String>;

    /// Opens a file of the model in the user's editor; line and column count from 1.
    ///
    /// # Errors
    /// Why not, for people, without any path.
    fn open(&self, file: &std::path::Path, line: usize, column: usize) -> Result<(), String>;
}

/// What all requests share.
#[derive(Clone)]
struct Page {
    room: Arc<Room>,
    service: Arc<dyn Service>,
    port: u16,
}

/// Finds a port on this machine alone: `wanted`, one of the next ones if that is taken, or any; any at once for 0.
///
/// # Errors
/// If there is none at all.
pub fn bind(wanted: u16) -> io::Result<TcpListener> {
    let last = if wanted == 0 {
        0
    } else {
        wanted.saturating_add(NEXT_PORTS)
    };
    let tried = wanted..=last;
    let bound = tried
        .map(|port| TcpListener::bind(SocketAddr::from((Ipv4Addr::LOCALHOST, port))))
        .find_map(Result::ok);
    match bound {
        Some(listener) => Ok(listener),
        None => TcpListener::bind(SocketAddr::from((Ipv4Addr::LOCALHOST, 0))),
    }
}

/// Serves the page until the room is closed. Blocks; has a thread of its own.
///
/// # Errors
/// If the system takes the port away.
pub fn serve(listener: TcpListener, room: Arc<Room>, service: Arc<dyn Service>) -> io::Result<()> {
    let port = listener.local_addr()?.port();
    listener.set_nonblocking(true)?;
    let runtime = tokio::runtime::Builder::new_current_thread()
        .enable_io()
        .enable_time()
        .build()?;
    let page = Page {
        room: room.clone(),
        service,
        port,
    };
    runtime.block_on(async move {
        let listener = tokio::net::TcpListener::from_std(listener)?;
        let server =
            axum::serve(listener, router(page)).with_graceful_shutdown(closed(room.clone()));
        let server = tokio::spawn(server.into_future());
        closed(room).await;
        // Who does not leave is left.
        let _ = tokio::time::timeout(FAREWELL, server).await;
        Ok(())
    })
}

/// Ends when the room is closed.
async fn closed(room: Arc<Room>) {
    let mut changes = room.changes();
    while !room.is_closed() {
        if changes.changed().await.is_err() {
            return;
        }
    }
}

fn router(page: Page) -> Router {
    let mut router = Router::new()
        .route("/events", get(events))
        .route("/frame/{number}", get(frame))
        .route("/picture.png", get(picture))
        .route("/wish", post(wish))
        .route("/write", post(write))
        .route("/open", post(open));
    for (path, kind, content) in ASSETS {
        let serve = move || async move { ([(header::CONTENT_TYPE, kind)], content) };
        router = router.route(path, get(serve));
    }
    router
        .layer(DefaultBodyLimit::max(LARGEST_REQUEST))
        .layer(middleware::from_fn_with_state(page.clone(), guarded))
        .with_state(page)
}

/// Turns away who has no business here, and tells browsers to do the same.
async fn guarded(State(page): State<Page>, request: Request, next: Next) -> Response {
    let mut response = match guard::refusal(request.method(), request.headers(), page.port) {
        Some(why) => (StatusCode::FORBIDDEN, why).into_response(),
        None => next.run(request).await,
    };
    for (name, value) in HEADERS {
        let headers = response.headers_mut();
        headers.insert(name, HeaderValue::from_static(value));
    }
    response
}

async fn events(State(page): State<Page>) -> Sse<impl Stream<Item = Result<Event, Infallible>>> {
    let mut changes = page.room.changes();
    changes.mark_changed();
    let states = stream::unfold((page.room, changes), |(room, mut changes)| async move {
        changes.changed().await.ok()?;
        let event = Event::default().event("state").data(room.state()?);
        Some((Ok(event), (room, changes)))
    });
    Sse::new(states).keep_alive(KeepAlive::default())
}

async fn frame(State(page): State<Page>, Path(number): Path<u64>) -> Response {
    match page.room.frame(number) {
        Some(file) => content(file),
        None => (StatusCode::NOT_FOUND, "there is a newer picture").into_response(),
    }
}

async fn picture(State(page): State<Page>) -> Response {
    match page.room.whole() {
        Some(file) => content(file),
        None => (StatusCode::NOT_FOUND, "there is no finished picture yet").into_response(),
    }
}

fn content(file: File) -> Response {
    let body = Body::from(file.bytes.to_vec());
    ([(header::CONTENT_TYPE, file.kind)], body).into_response()
}

async fn wish(State(page): State<Page>, Json(wish): Json<Wish>) -> Response {
    match page.service.check(&wish) {
        Ok(()) => {
            page.room.ask(wish);
            StatusCode::NO_CONTENT.into_response()
        }
        Err(why) => refused(why),
    }
}

async fn write(State(page): State<Page>, Json(wish): Json<Wish>) -> Response {
    let checked = page.service.check(&wish);
    match checked.and_then(|()| page.service.write(&wish)) {
        Ok(told) => told.into_response(),
        Err(why) => refused(why),
    }
}

/// A place to open.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
struct Place {
    file: u16,
    line: usize,
    column: usize,
}

async fn open(State(page): State<Page>, Json(place): Json<Place>) -> Response {
    let Some(file) = page.room.file(place.file) else {
        return refused("the model has no such file any more".to_owned());
    };
    match page.service.open(&file, place.line, place.column) {
        Ok(()) => StatusCode::NO_CONTENT.into_response(),
        Err(why) => refused(why),
    }
}

fn refused(why: String) -> Response {
    (StatusCode::UNPROCESSABLE_ENTITY, why).into_response()
}
