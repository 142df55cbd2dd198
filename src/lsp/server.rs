//! The conversation with an editor.

use super::workspace::{Analysis, FileView, Workspace, path_of};
use super::{calling, completion, faults, meaning, outline, renaming, wire};
use crate::pipeline::world::World;
use lsp_types::{
    CompletionOptions, CompletionParams, DidChangeTextDocumentParams, DidCloseTextDocumentParams,
    DidOpenTextDocumentParams, DocumentSymbolParams, DocumentSymbolResponse, GotoDefinitionParams,
    Hover, HoverContents, HoverParams, HoverProviderCapability, InitializeResult, Location,
    MarkupContent, MarkupKind, OneOf, ReferenceParams, RenameOptions, RenameParams,
    ServerCapabilities, ServerInfo, SignatureHelpOptions, SignatureHelpParams,
    TextDocumentPositionParams, TextDocumentSyncCapability, TextDocumentSyncKind,
    TextDocumentSyncOptions, Uri, WorkDoneProgressOptions,
};
use serde::Serialize;
use serde::de::DeserializeOwned;
use serde_json::{Value, json};
use std::collections::BTreeMap;
use std::io::{self, BufRead, Write};
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::str::FromStr;
use std::sync::mpsc::{Receiver, channel};
use wire::Incoming;

/// How a conversation ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Ended {
    /// As agreed: `shutdown`, then `exit`.
    Politely,
    /// `exit` without `shutdown`.
    Abruptly,
    /// The pipe was closed.
    Silently,
}

/// Why a request was not answered, by the protocol's numbers.
struct Refusal {
    code: i32,
    message: String,
}

const PARSE_ERROR: i32 = -32700;
const INVALID_REQUEST: i32 = -32600;
const METHOD_NOT_FOUND: i32 = -32601;
const INVALID_PARAMS: i32 = -32602;
const INTERNAL_ERROR: i32 = -32603;
const NOT_INITIALIZED: i32 = -32002;
const CANCELLED: i32 = -32800;
const REQUEST_FAILED: i32 = -32803;

fn refusal(code: i32, message: impl Into<String>) -> Refusal {
    Refusal {
        code,
        message: message.into(),
    }
}

/// Talks with an editor until it leaves.
///
/// A thread reads, so that nothing the editor sends has to wait. All that has come in is taken at once: of several changes
/// of a text only the last one is checked, and what was asked and taken back is not answered.
///
/// # Errors
/// If nothing can be written any more.
pub fn serve(
    world: &dyn World,
    input: impl BufRead + Send,
    mut output: impl Write,
) -> io::Result<Ended> {
    std::thread::scope(|scope| {
        let (sender, incoming) = channel();
        scope.spawn(move || {
            let mut input = input;
            // A pipe that breaks is a pipe that ends.
            while let Ok(Some(message)) = wire::read(&mut input) {
                let is_last = matches!(&message, Incoming::Message(m) if m["method"] == "exit");
                if sender.send(message).is_err() || is_last {
                    return;
                }
            }
        });
        Server::new(world).converse(&incoming, &mut output)
    })
}

struct Server<'w> {
    workspace: Workspace<'w>,
    is_initialized: bool,
    is_shut_down: bool,
    /// Whether faults have to be told again.
    is_dirty: bool,
    /// The faults told last, by address.
    told: BTreeMap<String, Value>,
}

impl<'w> Server<'w> {
    fn new(world: &'w dyn World) -> Self {
        Self {
            workspace: Workspace::new(world),
            is_initialized: false,
            is_shut_down: false,
            is_dirty: false,
            told: BTreeMap::new(),
        }
    }

    fn converse(
        &mut self,
        incoming: &Receiver<Incoming>,
        output: &mut impl Write,
    ) -> io::Result<Ended> {
        while let Ok(first) = incoming.recv() {
            let mut batch = vec![first];
            batch.extend(incoming.try_iter());
            let cancelled = cancelled(&batch);
            for message in batch {
                match message {
                    Incoming::Message(message) if message["method"] == "exit" => {
                        return Ok(if self.is_shut_down {
                            Ended::Politely
                        } else {
                            Ended::Abruptly
                        });
                    }
                    Incoming::Message(message) => {
                        if let Some(answer) = self.take(&message, &cancelled) {
                            wire::write(output, &answer)?;
                        }
                    }
                    Incoming::Broken(why) => {
                        wire::write(output, &refused(&Value::Null, &refusal(PARSE_ERROR, why)))?;
                    }
                }
            }
            if std::mem::take(&mut self.is_dirty) {
                for faults in self.guarded(Self::faults).unwrap_or_default() {
                    wire::write(output, &faults)?;
                }
            }
        }
        Ok(Ended::Silently)
    }

    /// Does something that may fail without ending the conversation.
    fn guarded<T>(&mut self, work: impl FnOnce(&mut Self) -> T) -> Option<T> {
        catch_unwind(AssertUnwindSafe(|| work(self))).ok()
    }

    /// Takes a message; gives the answer, if it wants one.
    fn take(&mut self, message: &Value, cancelled: &[Value]) -> Option<Value> {
        let method = message["method"].as_str();
        let id = message
            .get("id")
            .filter(|id| id.is_string() || id.is_number());
        match (method, id) {
            (Some(method), Some(id)) => {
                let answer = if cancelled.contains(id) {
                    Err(refusal(CANCELLED, "taken back"))
                } else {
                    self.guarded(|server| server.request(method, &message["params"]))
                        .unwrap_or_else(|| {
                            Err(refusal(
                                INTERNAL_ERROR,
                                "this is a fault of understory; please report it",
                            ))
                        })
                };
                Some(match answer {
                    Ok(result) => json!({ "jsonrpc": "2.0", "id": id, "result": result }),
                    Err(refusal) => refused(id, &refusal),
                })
            }
            (Some(method), None) => {
                self.guarded(|server| server.notice(method, &message["params"]));
                None
            }
            // An answer to something that was never asked.
            (None, Some(_))
                if message.get("result").is_some() || message.get("error").is_some() =>
            {
                None
            }
            (None, id) => {
                let refusal = refusal(INVALID_REQUEST, "a message needs a `method`");
                Some(refused(id.unwrap_or(&Value::Null), &refusal))
            }
        }
    }

    fn request(&mut self, method: &str, params: &Value) -> Result<Value, Refusal> {
        match method {
            "initialize" => {
                self.is_initialized = true;
                return answer(&introduction());
            }
            _ if !self.is_initialized => {
                return Err(refusal(NOT_INITIALIZED, "`initialize` comes first"));
            }
            "shutdown" => {
                self.is_shut_down = true;
                return Ok(Value::Null);
            }
            _ if self.is_shut_down => return Err(refusal(INVALID_REQUEST, "it was shut down")),
            _ => {}
        }
        match method {
            "textDocument/hover" => {
                let params: HoverParams = read(params)?;
                answer(&self.hover(&params.text_document_position_params))
            }
            "textDocument/definition" => {
                let params: GotoDefinitionParams = read(params)?;
                answer(&self.definition(&params.text_document_position_params))
            }
            "textDocument/completion" => {
                let params: CompletionParams = read(params)?;
                answer(&self.completion(&params.text_document_position))
            }
            "textDocument/signatureHelp" => {
                let params: SignatureHelpParams = read(params)?;
                let at = params.text_document_position_params;
                answer(&self.located(&at, calling::help))
            }
            "textDocument/references" => {
                let params: ReferenceParams = read(params)?;
                let is_wanted = params.context.include_declaration;
                answer(&self.references(&params.text_document_position, is_wanted))
            }
            "textDocument/prepareRename" => {
                let at: TextDocumentPositionParams = read(params)?;
                answer(&self.located(&at, |analysis, file, byte| {
                    let (word, _) = renaming::occurrences(analysis, file, byte)?;
                    Some(file.lines.range(&file.text, word))
                }))
            }
            "textDocument/rename" => {
                let params: RenameParams = read(params)?;
                let at = params.text_document_position;
                let renamed = self.located(&at, |analysis, file, byte| {
                    Some(renaming::rename(analysis, file, byte, &params.new_name))
                });
                match renamed {
                    Some(Ok(edits)) => answer(&json!({ "changes": edits })),
                    Some(Err(why)) => Err(refusal(REQUEST_FAILED, why)),
                    None => Ok(Value::Null),
                }
            }
            "textDocument/documentSymbol" => {
                let params: DocumentSymbolParams = read(params)?;
                answer(&self.outline(&params.text_document.uri))
            }
            _ => Err(refusal(
                METHOD_NOT_FOUND,
                format!("`{method}` is not offered"),
            )),
        }
    }

    /// What the editor tells without waiting for an answer. What makes no sense is passed over.
    fn notice(&mut self, method: &str, params: &Value) {
        match method {
            "textDocument/didOpen" => {
                if let Ok(DidOpenTextDocumentParams { text_document: it }) = read(params) {
                    self.workspace.put(it.uri.as_str(), it.version, &it.text);
                }
            }
            "textDocument/didChange" => {
                if let Ok(DidChangeTextDocumentParams {
                    text_document: it,
                    content_changes,
                }) = read(params)
                    && let Some(last) = content_changes
                        .last()
                        .filter(|change| change.range.is_none())
                    && self.workspace.text(it.uri.as_str()).is_some()
                {
                    self.workspace.put(it.uri.as_str(), it.version, &last.text);
                }
            }
            "textDocument/didClose" => {
                if let Ok(DidCloseTextDocumentParams { text_document: it }) = read(params) {
                    self.workspace.close(it.uri.as_str());
                }
            }
            // Other files may have changed on disk.
            "textDocument/didSave" | "workspace/didChangeWatchedFiles" => {}
            _ => return,
        }
        self.is_dirty = true;
    }

    /// The faults that have changed, as messages.
    fn faults(&mut self) -> Vec<Value> {
        let mut now: BTreeMap<String, Value> = BTreeMap::new();
        for path in self.workspace.open_paths() {
            let Some(analysis) = self.workspace.analysis(&path) else {
                continue;
            };
            for file in &analysis.files {
                let faults =
                    faults::of_file(&analysis, file).and_then(|f| serde_json::to_value(f).ok());
                now.extend(faults.map(|faults| (file.uri.clone(), faults)));
            }
        }
        let mut messages = vec![];
        for (uri, faults) in &now {
            let is_idle = faults["version"].is_null() && faults["diagnostics"] == json!([]);
            let is_news = match self.told.get(uri) {
                Some(before) => before != faults,
                None => !is_idle,
            };
            if is_news {
                messages.push(published(faults));
            }
        }
        for uri in self.told.keys().filter(|uri| !now.contains_key(*uri)) {
            messages.push(published(&json!({ "uri": uri, "diagnostics": [] })));
        }
        self.told = now;
        messages
    }

    fn hover(&mut self, at: &TextDocumentPositionParams) -> Option<Hover> {
        let path = path_of(at.text_document.uri.as_str());
        let analysis = self.workspace.analysis(&path)?;
        let file = analysis.file_at(&path)?;
        let (word, thing) = meaning::at(&analysis, file, file.lines.byte(&file.text, at.position))?;
        let content = MarkupContent {
            kind: MarkupKind::Markdown,
            value: thing.markdown(),
        };
        Some(Hover {
            contents: HoverContents::Markup(content),
            range: Some(file.lines.range(&file.text, word)),
        })
    }

    fn definition(&mut self, at: &TextDocumentPositionParams) -> Option<Location> {
        let path = path_of(at.text_document.uri.as_str());
        let analysis = self.workspace.analysis(&path)?;
        let file = analysis.file_at(&path)?;
        let (_, thing) = meaning::at(&analysis, file, file.lines.byte(&file.text, at.position))?;
        let (file, bytes) = match thing {
            meaning::Thing::Symbol(symbol) => (analysis.file(symbol.name_span)?, symbol.name_span),
            meaning::Thing::Local(local) => (analysis.file(local.declared)?, local.declared),
            meaning::Thing::File(file) => (file, crate::diag::Span::default()),
            _ => return None,
        };
        let range = file
            .lines
            .range(&file.text, bytes.start as usize..bytes.end as usize);
        Some(Location {
            uri: Uri::from_str(&file.uri).ok()?,
            range,
        })
    }

    fn completion(
        &mut self,
        at: &TextDocumentPositionParams,
    ) -> Option<Vec<lsp_types::CompletionItem>> {
        self.located(at, |analysis, file, byte| {
            Some(completion::complete(analysis, file, byte))
        })
    }

    /// What is known of a place: of the model, the file, and the byte.
    fn located<T>(
        &mut self,
        at: &TextDocumentPositionParams,
        find: impl FnOnce(&Analysis, &FileView, usize) -> Option<T>,
    ) -> Option<T> {
        let path = path_of(at.text_document.uri.as_str());
        let analysis = self.workspace.analysis(&path)?;
        let file = analysis.file_at(&path)?;
        find(&analysis, file, file.lines.byte(&file.text, at.position))
    }

    fn references(
        &mut self,
        at: &TextDocumentPositionParams,
        with_declaration: bool,
    ) -> Option<Vec<Location>> {
        self.located(at, |analysis, file, byte| {
            let (_, places) = renaming::occurrences(analysis, file, byte)?;
            let is_declared = |span: &crate::diag::Span| {
                let locals = &analysis.survey.locals;
                analysis.symbols().any(|symbol| symbol.name_span == *span)
                    || locals.iter().any(|local| local.declared == *span)
            };
            let places = places.into_iter();
            let wanted = places.filter(|span| with_declaration || !is_declared(span));
            let located = wanted.filter_map(|span| {
                let file = analysis.file(span)?;
                let bytes = span.start as usize..span.end as usize;
                Some(Location {
                    uri: Uri::from_str(&file.uri).ok()?,
                    range: file.lines.range(&file.text, bytes),
                })
            });
            Some(located.collect())
        })
    }

    fn outline(&mut self, uri: &Uri) -> Option<DocumentSymbolResponse> {
        let path = path_of(uri.as_str());
        let analysis = self.workspace.analysis(&path)?;
        let file = analysis.file_at(&path)?;
        Some(DocumentSymbolResponse::Nested(outline::outline(file)))
    }
}

/// The ids of requests that are taken back.
fn cancelled(batch: &[Incoming]) -> Vec<Value> {
    let ids = batch.iter().filter_map(|incoming| match incoming {
        Incoming::Message(message) if message["method"] == "$/cancelRequest" => {
            message["params"].get("id").cloned()
        }
        _ => None,
    });
    ids.collect()
}

fn read<T: DeserializeOwned>(params: &Value) -> Result<T, Refusal> {
    T::deserialize(params).map_err(|error| refusal(INVALID_PARAMS, error.to_string()))
}

fn answer(result: &impl Serialize) -> Result<Value, Refusal> {
    serde_json::to_value(result).map_err(|error| refusal(INTERNAL_ERROR, error.to_string()))
}

fn refused(id: &Value, refusal: &Refusal) -> Value {
    json!({ "jsonrpc": "2.0", "id": id, "error": { "code": refusal.code, "message": refusal.message } })
}

fn published(faults: &Value) -> Value {
    json!({ "jsonrpc": "2.0", "method": "textDocument/publishDiagnostics", "params": faults })
}

/// What this server can do.
fn introduction() -> InitializeResult {
    let sync = TextDocumentSyncOptions {
        open_close: Some(true),
        change: Some(TextDocumentSyncKind::FULL),
        save: Some(true.into()),
        ..TextDocumentSyncOptions::default()
    };
    let completion = CompletionOptions {
        trigger_characters: Some([".", "["].map(str::to_owned).to_vec()),
        ..CompletionOptions::default()
    };
    InitializeResult {
        capabilities: ServerCapabilities {
            text_document_sync: Some(TextDocumentSyncCapability::Options(sync)),
            hover_provider: Some(HoverProviderCapability::Simple(true)),
            completion_provider: Some(completion),
            definition_provider: Some(OneOf::Left(true)),
            document_symbol_provider: Some(OneOf::Left(true)),
            references_provider: Some(OneOf::Left(true)),
            rename_provider: Some(OneOf::Right(RenameOptions {
                prepare_provider: Some(true),
                work_done_progress_options: WorkDoneProgressOptions::default(),
            })),
            signature_help_provider: Some(SignatureHelpOptions {
                trigger_characters: Some(["(", ","].map(str::to_owned).to_vec()),
                ..SignatureHelpOptions::default()
            }),
            ..ServerCapabilities::default()
        },
        server_info: Some(ServerInfo {
            name: "understory".into(),
            version: Some(env!("CARGO_PKG_VERSION").into()),
        }),
    }
}
