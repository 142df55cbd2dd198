//! The language server as an editor meets it: the program is started, and talked to over its pipes.

#![allow(clippy::unwrap_used, reason = "a test fails by panicking")]

use serde_json::{Value, json};
use std::io::{BufRead, BufReader, Read, Write};
use std::path::Path;
use std::process::{Child, ChildStdin, ChildStdout, Command, Stdio};
use tempfile::TempDir;

/// An editor with the server it talks to.
struct Editor {
    server: Child,
    input: ChildStdin,
    output: BufReader<ChildStdout>,
    folder: TempDir,
    n_requests: i32,
    n_changes: i32,
    /// Faults told last, by file name.
    faults: Vec<(String, Value)>,
}

impl Editor {
    /// An editor before `initialize`.
    fn start() -> Self {
        let mut server = Command::new(env!("CARGO_BIN_EXE_understory"))
            .args(["lsp", "--stdio"])
            .stdin(Stdio::piped())
            .stdout(Stdio::piped())
            .spawn()
            .unwrap();
        Self {
            input: server.stdin.take().unwrap(),
            output: BufReader::new(server.stdout.take().unwrap()),
            server,
            folder: tempfile::tempdir().unwrap(),
            n_requests: 0,
            n_changes: 0,
            faults: vec![],
        }
    }

    /// An editor that has said hello, with files on disk; the first is open.
    fn with(files: &[(&str, &str)]) -> Self {
        let mut editor = Self::start();
        for (name, text) in files {
            std::fs::write(editor.folder.path().join(name), text).unwrap();
        }
        let hello = editor.ask(
            "initialize",
            json!({ "capabilities": {}, "processId": null, "rootUri": null }),
        );
        assert_eq!(hello["capabilities"]["hoverProvider"], true);
        editor.tell("initialized", json!({}));
        if let Some((name, text)) = files.first() {
            editor.open(name, text);
        }
        editor
    }

    fn uri(&self, name: &str) -> String {
        format!("file://{}/{name}", self.folder.path().display())
    }

    fn send_raw(&mut self, bytes: &[u8]) {
        self.input.write_all(bytes).unwrap();
        self.input.flush().unwrap();
    }

    fn send(&mut self, message: &Value) {
        let text = message.to_string();
        self.send_raw(format!("Content-Length: {}\r\n\r\n{text}", text.len()).as_bytes());
    }

    fn receive(&mut self) -> Value {
        let mut length = 0;
        loop {
            let mut line = String::new();
            assert!(
                self.output.read_line(&mut line).unwrap() > 0,
                "the server has gone"
            );
            match line.trim().split_once(": ") {
                Some((_, number)) => length = number.parse().unwrap(),
                None => break,
            }
        }
        let mut body = vec![0; length];
        self.output.read_exact(&mut body).unwrap();
        serde_json::from_slice(&body).unwrap()
    }

    fn tell(&mut self, method: &str, params: Value) {
        self.send(&json!({ "jsonrpc": "2.0", "method": method, "params": params }));
    }

    /// The next message that is no report of faults; those are kept.
    fn receive_answer(&mut self) -> Value {
        loop {
            let message = self.receive();
            if message["method"] != "textDocument/publishDiagnostics" {
                return message;
            }
            let uri = message["params"]["uri"].as_str().unwrap();
            let name = uri.rsplit('/').next().unwrap().to_owned();
            self.faults.retain(|(known, _)| *known != name);
            self.faults.push((name, message["params"].clone()));
        }
    }

    /// The whole answer to a request.
    fn request(&mut self, method: &str, params: Value) -> Value {
        self.n_requests += 1;
        let id = self.n_requests;
        self.send(&json!({ "jsonrpc": "2.0", "id": id, "method": method, "params": params }));
        let answer = self.receive_answer();
        assert_eq!(answer["id"], id, "{answer}");
        answer
    }

    fn ask(&mut self, method: &str, params: Value) -> Value {
        let answer = self.request(method, params);
        assert!(answer.get("error").is_none(), "{method}: {answer}");
        answer["result"].clone()
    }

    fn open(&mut self, name: &str, text: &str) {
        let uri = self.uri(name);
        let document = json!({ "uri": uri, "languageId": "rgg", "version": 1, "text": text });
        self.tell("textDocument/didOpen", json!({ "textDocument": document }));
    }

    fn change(&mut self, name: &str, text: &str) {
        self.n_changes += 1;
        let document = json!({ "uri": self.uri(name), "version": 1 + self.n_changes });
        self.tell(
            "textDocument/didChange",
            json!({ "textDocument": document, "contentChanges": [{ "text": text }] }),
        );
    }

    /// The faults of a file after all that was sent: `line:character code`.
    fn faults(&mut self, name: &str) -> Vec<String> {
        // Faults are told before the next message is taken, and this one is answered.
        self.ask(
            "textDocument/documentSymbol",
            json!({ "textDocument": { "uri": self.uri(name) } }),
        );
        self.ask(
            "textDocument/documentSymbol",
            json!({ "textDocument": { "uri": self.uri(name) } }),
        );
        let Some((_, told)) = self.faults.iter().find(|(known, _)| known == name) else {
            return vec![];
        };
        let line = |fault: &Value| {
            let start = &fault["range"]["start"];
            format!(
                "{}:{} {}",
                start["line"],
                start["character"],
                fault["code"].as_str().unwrap()
            )
        };
        told["diagnostics"]
            .as_array()
            .unwrap()
            .iter()
            .map(line)
            .collect()
    }

    /// Puts `marked` without its `|` into a file, and gives the place of the `|`.
    fn change_to(&mut self, name: &str, marked: &str) -> Value {
        let before = &marked[..marked.find('|').unwrap()];
        let line = before.matches('\n').count();
        let character = before.rsplit('\n').next().unwrap().encode_utf16().count();
        self.change(name, &marked.replacen('|', "", 1));
        json!({
            "textDocument": { "uri": self.uri(name) },
            "position": { "line": line, "character": character },
        })
    }

    /// What a hover shows at the `|`.
    fn hover(&mut self, marked: &str) -> String {
        let at = self.change_to("m.rgg", marked);
        let shown = self.ask("textDocument/hover", at);
        shown["contents"]["value"]
            .as_str()
            .unwrap_or_default()
            .to_owned()
    }

    /// Where the name at the `|` is declared: `file:line:character`.
    fn definition(&mut self, marked: &str) -> String {
        let at = self.change_to("m.rgg", marked);
        let found = self.ask("textDocument/definition", at);
        let Some(uri) = found["uri"].as_str() else {
            return String::new();
        };
        let start = &found["range"]["start"];
        format!(
            "{}:{}:{}",
            uri.rsplit('/').next().unwrap(),
            start["line"],
            start["character"]
        )
    }

    /// The names offered at the `|`, best first.
    fn completion(&mut self, marked: &str) -> Vec<String> {
        let at = self.change_to("m.rgg", marked);
        let found = self.ask("textDocument/completion", at);
        let mut items: Vec<&Value> = found.as_array().unwrap().iter().collect();
        items.sort_by_key(|item| item["sortText"].as_str().unwrap().to_owned());
        items
            .iter()
            .map(|item| item["label"].as_str().unwrap().to_owned())
            .collect()
    }

    /// The ways of calling what is being called at the `|`, the active one marked `*`, and the active parameter.
    fn signatures(&mut self, marked: &str) -> (Vec<String>, u64) {
        let at = self.change_to("m.rgg", marked);
        let found = self.ask("textDocument/signatureHelp", at);
        let Some(forms) = found["signatures"].as_array() else {
            return (vec![], 0);
        };
        let label = |(number, form): (usize, &Value)| {
            let mark = if found["activeSignature"] == number {
                "*"
            } else {
                ""
            };
            format!("{mark}{}", form["label"].as_str().unwrap())
        };
        let labels = forms.iter().enumerate().map(label).collect();
        (labels, found["activeParameter"].as_u64().unwrap())
    }

    /// The texts of all files after a renaming of what is at the `|` of the first one; the reason if it is refused.
    fn rename(
        &mut self,
        marked: &str,
        others: &[(&str, &str)],
        new: &str,
    ) -> Result<String, String> {
        let at = self.change_to("m.rgg", marked);
        let mut params = at.clone();
        params["newName"] = new.into();
        let answer = self.request("textDocument/rename", params);
        if let Some(why) = answer["error"]["message"].as_str() {
            return Err(why.to_owned());
        }
        let mut shown = String::new();
        let own = marked.replacen('|', "", 1);
        for (name, text) in std::iter::once(("m.rgg", own.as_str())).chain(others.iter().copied()) {
            let edits = &answer["result"]["changes"][self.uri(name)];
            let mut lines: Vec<String> = text.lines().map(str::to_owned).collect();
            let edits: Vec<&Value> = edits.as_array().into_iter().flatten().collect();
            for edit in edits.iter().rev() {
                let (start, end) = (&edit["range"]["start"], &edit["range"]["end"]);
                assert_eq!(start["line"], end["line"]);
                // The texts of these tests are ASCII: units are bytes.
                let column = |place: &Value| place["character"].as_u64().unwrap() as usize;
                let line = &mut lines[start["line"].as_u64().unwrap() as usize];
                line.replace_range(
                    column(start)..column(end),
                    edit["newText"].as_str().unwrap(),
                );
            }
            shown.push_str(&lines.join("\n"));
            shown.push('\n');
        }
        Ok(shown)
    }

    /// Says goodbye; the server's exit code.
    fn leave(mut self) -> i32 {
        self.ask("shutdown", Value::Null);
        self.tell("exit", Value::Null);
        self.server.wait().unwrap().code().unwrap()
    }
}

const MODEL: &str = "\
// A leaf, flat.
module Leaf(float size) extends Null { int age; int older(int days) { return age + days; } }
module Bud;
float k = 0.5; // extinction
protected void init() [ Axiom ==> Bud Leaf(1); ]
public void run() [
";

fn in_run(rest: &str) -> String {
    format!("{MODEL}{rest}\n]\n")
}

#[test]
fn an_editor_says_hello_and_goodbye() {
    let mut editor = Editor::with(&[("m.rgg", MODEL)]);
    let refused = editor.request("textDocument/formatting", json!({}));
    assert_eq!(refused["error"]["code"], -32601);
    assert_eq!(editor.leave(), 0);
    // Before `initialize` nothing is answered, and whoever leaves without `shutdown` is told.
    let mut editor = Editor::start();
    let refused = editor.request("textDocument/hover", json!({}));
    assert_eq!(refused["error"]["code"], -32002);
    editor.tell("exit", Value::Null);
    assert_eq!(editor.server.wait().unwrap().code(), Some(3));
    // A closed pipe ends it too.
    let Editor {
        mut server, input, ..
    } = Editor::start();
    drop(input);
    assert_eq!(server.wait().unwrap().code(), Some(0));
}

#[test]
fn faults_follow_the_text() {
    let mut editor = Editor::with(&[("m.rgg", &in_run("Bud ==> Lef(1);"))]);
    assert_eq!(editor.faults("m.rgg"), ["6:8 unknown-module"]);
    let fault = editor.faults[0].1["diagnostics"][0].clone();
    assert_eq!(fault["severity"], 1);
    let message = fault["message"].as_str().unwrap();
    assert!(
        message.contains("unknown module `Lef`") && message.contains("did you mean `Leaf`?"),
        "{message}"
    );
    editor.change("m.rgg", &in_run("Bud ==> Leaf(1)"));
    assert_eq!(editor.faults("m.rgg"), ["6:14 missing-semicolon"]);
    editor.change("m.rgg", &in_run("Bud ==> Leaf(1);"));
    assert!(editor.faults("m.rgg").is_empty());
    // UTF-16 places, and warnings.
    editor.change("m.rgg", &in_run("Bud ==> Leaf(1); /* 𝄞ä */ Bud ==> ;"));
    assert_eq!(editor.faults("m.rgg"), ["6:27 dead-rule"]);
    let fault = editor.faults[0].1["diagnostics"][0].clone();
    assert_eq!(
        (&fault["severity"], &fault["tags"][0]),
        (&json!(2), &json!(1))
    );
    assert_eq!(
        fault["relatedInformation"][0]["location"]["range"]["start"]["character"],
        0
    );
    // A closed text has no faults.
    let uri = editor.uri("m.rgg");
    editor.tell(
        "textDocument/didClose",
        json!({ "textDocument": { "uri": uri } }),
    );
    editor.ask(
        "textDocument/hover",
        json!({ "textDocument": { "uri": uri }, "position": { "line": 0, "character": 0 } }),
    );
    assert!(editor.faults("m.rgg").is_empty());
    assert_eq!(editor.leave(), 0);
}

#[test]
fn of_many_changes_the_last_one_counts() {
    let mut editor = Editor::with(&[("m.rgg", MODEL)]);
    for n in 0..200 {
        editor.change("m.rgg", &in_run(&format!("Bud ==> Lef({n});")));
    }
    editor.change("m.rgg", &in_run("Bud ==> Leaf(1);"));
    assert!(editor.faults("m.rgg").is_empty());
    let version = editor.faults[0].1["version"].clone();
    assert_eq!(version, 202);
    assert_eq!(editor.leave(), 0);
}

#[test]
fn a_hover_tells_what_a_word_means() {
    let mut editor = Editor::with(&[("m.rgg", MODEL)]);
    let cases = [
        ("Bud ==> F(1) RU|(30);", "Turns about local y"),
        ("Bud ==> F(1) RU|(30);", "float angle = 0 degrees"),
        (
            "Bud ==> L|eaf(1);",
            "module Leaf(float size) extends Null\n```\n\nA leaf, flat.",
        ),
        ("x:Leaf ::> { x[ag|e] = 3; }", "int age"),
        ("x:Leaf ::> { |x[age] = 3; }", "Leaf x"),
        ("Leaf(s) ==> F(|s);", "float s"),
        ("Bud ==> F(|k);", "float k = 0.5\n```\n\nextinction"),
        (
            "x:Leaf ::> println(x.old|er(2));",
            "int Leaf.older(int days)",
        ),
        ("Bud ==> F(Math.s|qrt(2));", "double Math.sqrt(double x)"),
        ("Bud ==> F(ran|dom(1, 2));", "Uniform in [a, b)"),
        (
            "Bud ==> F(ran|dom(1, 2));",
            "float random(float a, float b)",
        ),
        ("x:F ::> println(x[le|ngth]);", "float length = 1 m"),
        ("Bud ==> F(sum|((* Leaf *)[age]));", "Sum of the values"),
        ("Bud ==> Sphere(1).(setShader(GR|EEN));", "rgb(0, 255, 0)"),
        ("Bud =|=> Leaf(1);", ""),
        ("Bud ==> Leaf(1); // RU|(30)", ""),
        // Half-typed text.
        (
            "Bud ==> F(1) [ RU|(30 \nLeaf(s) ==> F(s);",
            "Turns about local y",
        ),
        ("x:Leaf ::> { x.\n ol|der(2); }", "int Leaf.older(int days)"),
        ("Bud ==> Le|af(", "module Leaf(float size)"),
    ];
    for (rest, expected) in cases {
        let shown = editor.hover(&in_run(rest));
        assert!(
            shown.contains(expected) && shown.is_empty() == expected.is_empty(),
            "{rest}: {shown}"
        );
    }
    assert_eq!(editor.leave(), 0);
}

#[test]
fn declarations_are_found_across_files() {
    let other =
        "// Parameters.\nfloat rate = 2;\nint twice(int n) { return 2 * n; }\nmodule Far(int n);\n";
    let mut editor = Editor::with(&[("m.rgg", MODEL), ("params.rgg", other)]);
    for (rest, expected) in [
        ("Bud ==> Le|af(1);", "m.rgg:1:7"),
        ("Bud ==> Fa|r(1);", "params.rgg:3:7"),
        ("Bud ==> F(ra|te);", "params.rgg:1:6"),
        ("Bud ==> F(params.ra|te);", "params.rgg:1:6"),
        ("Bud ==> F(par|ams.rate);", "params.rgg:0:0"),
        ("Bud ==> F(tw|ice(2));", "params.rgg:2:4"),
        ("x:Leaf ::> x.older|(2);", "m.rgg:1:52"),
        ("x:Leaf ::> println(x.ag|e);", "m.rgg:1:43"),
        ("Leaf(si) ==> F(s|i);", "m.rgg:6:5"),
        ("y:Leaf, (|y[age] > 1) ==> ;", "m.rgg:6:0"),
        ("Bud ==> R|U(30);", ""),
    ] {
        assert_eq!(editor.definition(&in_run(rest)), expected, "{rest}");
    }
    // A change of an open file counts before it is saved.
    editor.open("params.rgg", &format!("\n\n{other}"));
    assert_eq!(
        editor.definition(&in_run("Bud ==> Fa|r(1);")),
        "params.rgg:5:7"
    );
    assert_eq!(editor.leave(), 0);
}

#[test]
fn what_could_stand_there_is_offered() {
    let mut editor = Editor::with(&[("m.rgg", MODEL)]);
    let cases: &[(&str, &[&str], &[&str])] = &[
        (
            "Bud ==> F(1) R|;",
            &["RU", "Leaf", "Bud", "random", "k"],
            &["age"],
        ),
        ("Bud ==> F(1) |", &["RU", "Leaf"], &["age"]),
        (
            "x:Leaf ::> { x.|; }",
            &["age", "size", "older", "layer"],
            &["RU", "x"],
        ),
        ("x:Leaf ::> { x.| }", &["age", "size", "older"], &["RU"]),
        (
            "x:Leaf ::> { x[|]++; }",
            &["age", "size", "layer"],
            &["older", "RU"],
        ),
        ("x:Leaf ::> { println(x[a|", &["age", "size"], &["RU"]),
        (
            "here:Leaf ::> { int days = 1; println(he|); }",
            &["here", "days", "k"],
            &["age"],
        ),
        ("here:Leaf, (he|", &["here", "k"], &["age"]),
        ("Leaf(width) ==> F(w|", &["width"], &[]),
        ("Bud ==> F(Math.|);", &["sqrt", "PI"], &["RU", "k"]),
        ("Bud ==> F(sum((* Lea|", &["Leaf", "Bud"], &[]),
        ("Bud ==> F(sum((* Leaf *)[|", &["age"], &["RU"]),
        (
            "Bud ==> Sphere(1).(|);",
            &["setShader", "setColor", "radius"],
            &[],
        ),
        (
            "Bud ==> Sphere(1).(setShader(|));",
            &["GREEN", "RGBAShader"],
            &[],
        ),
        (
            "{ Vector3d v = new Vector3d(); v.| }",
            &["x", "cross", "length"],
            &["RU"],
        ),
        ("{ String s = \"a\"; s.| }", &["length"], &["RU"]),
        ("{ String s = \"RU|\"; }", &[], &["RU"]),
        ("{ double d = 1.|; }", &[], &["RU", "k"]),
        ("// RU|", &[], &["RU"]),
        ("Bud ==> for (int i : 1:3) (F(|", &["i"], &[]),
    ];
    for (rest, present, absent) in cases {
        let names = editor.completion(&in_run(rest));
        let missing: Vec<_> = present
            .iter()
            .filter(|name| !names.iter().any(|n| n == *name))
            .collect();
        let surplus: Vec<_> = absent
            .iter()
            .filter(|name| names.iter().any(|n| n == *name))
            .collect();
        assert!(
            missing.is_empty() && surplus.is_empty(),
            "{rest}: no {missing:?}, but {surplus:?}: {names:?}"
        );
    }
    let first = &editor.completion(&in_run("zz:Leaf ::> println(|);"))[0];
    assert_eq!(first, "zz");
    // In a method of a module its members are in scope.
    let names = editor.completion(&MODEL.replace("return age", "return ag|e"));
    assert_eq!(names.iter().filter(|n| *n == "age").count(), 1);
    assert!(names.contains(&"days".to_owned()));
    assert_eq!(editor.leave(), 0);
}

#[test]
fn the_outline_nests_members_in_modules() {
    let mut editor = Editor::with(&[("m.rgg", MODEL)]);
    let uri = editor.uri("m.rgg");
    let found = editor.ask(
        "textDocument/documentSymbol",
        json!({ "textDocument": { "uri": uri } }),
    );
    let names = |list: &Value| -> Vec<String> {
        let all = list.as_array().unwrap().iter();
        all.map(|s| s["name"].as_str().unwrap().to_owned())
            .collect()
    };
    // `run` is open at the end of the text and cannot be read.
    assert_eq!(names(&found)[..4], ["Leaf", "Bud", "k", "init"]);
    assert_eq!(names(&found[0]["children"]), ["size", "age", "older"]);
    assert_eq!(editor.leave(), 0);
}

#[test]
fn nothing_that_is_sent_ends_it() {
    let mut editor = Editor::with(&[("m.rgg", MODEL)]);
    editor.send_raw(b"Content-Length: 7\r\n\r\n{broken");
    assert_eq!(editor.receive_answer()["error"]["code"], -32700);
    editor.send_raw(b"Content-Length: 99999999999999999999999\r\n\r\n");
    assert_eq!(editor.receive_answer()["error"]["code"], -32700);
    for message in [
        json!([]),
        json!(7),
        json!({ "id": 4 }),
        json!({ "id": null, "method": 3 }),
    ] {
        editor.send(&message);
        assert_eq!(
            editor.receive_answer()["error"]["code"],
            -32600,
            "{message}"
        );
    }
    let refused = editor.request("textDocument/hover", json!({ "position": "here" }));
    assert_eq!(refused["error"]["code"], -32602);
    editor.tell("textDocument/didOpen", json!([1, 2]));
    editor.tell(
        "textDocument/didChange",
        json!({ "textDocument": { "uri": "file:///none", "version": 1 }, "contentChanges": [] }),
    );
    editor.tell("no/such/thing", json!(null));
    // Places far outside, texts that are no models, addresses that are no files.
    let uri = editor.uri("m.rgg");
    let far = json!({ "textDocument": { "uri": uri }, "position": { "line": 4_000_000_000_u32, "character": 4_000_000_000_u32 } });
    editor.ask("textDocument/hover", far.clone());
    editor.ask("textDocument/completion", far);
    let lone =
        json!({ "uri": "untitled:x%20y", "languageId": "rgg", "version": 1, "text": "module A" });
    editor.tell("textDocument/didOpen", json!({ "textDocument": lone }));
    let unknown = json!({ "textDocument": { "uri": "file:///no/such.rgg" }, "position": { "line": 0, "character": 0 } });
    assert_eq!(editor.ask("textDocument/definition", unknown), Value::Null);
    for text in [
        "\0",
        "((((((((((",
        "/*",
        "\"",
        "module",
        "}{",
        "ä|",
        &"[".repeat(5000),
        &"a.".repeat(3000),
    ] {
        editor.change("m.rgg", text);
        for method in ["hover", "completion", "definition"] {
            let at = json!({ "textDocument": { "uri": uri }, "position": { "line": 0, "character": 3 } });
            editor.ask(&format!("textDocument/{method}"), at);
        }
    }
    // What was taken back is not answered as if it had not been.
    let mut both = String::new();
    for message in [
        json!({ "jsonrpc": "2.0", "id": 900, "method": "textDocument/hover", "params": {} }),
        json!({ "jsonrpc": "2.0", "method": "$/cancelRequest", "params": { "id": 900 } }),
    ] {
        let text = message.to_string();
        both.push_str(&format!("Content-Length: {}\r\n\r\n{text}", text.len()));
    }
    editor.send_raw(both.as_bytes());
    assert_eq!(editor.receive_answer()["id"], 900);
    assert_eq!(editor.leave(), 0);
}

#[test]
fn all_example_models_are_without_faults_and_complete_everywhere() {
    let examples = Path::new(env!("CARGO_MANIFEST_DIR")).join("examples");
    let text = std::fs::read_to_string(examples.join("poplar.rgg")).unwrap();
    let mut editor = Editor::with(&[("m.rgg", &text)]);
    assert!(editor.faults("m.rgg").is_empty());
    // Cut off anywhere, the text is still answered.
    let cuts = text.char_indices().map(|(at, _)| at).step_by(409);
    for cut in cuts {
        editor.completion(&format!("{}|", &text[..cut]));
    }
    assert_eq!(editor.leave(), 0);
}

#[test]
fn a_call_being_typed_shows_its_parameters() {
    let mut editor = Editor::with(&[("m.rgg", MODEL)]);
    let cases: &[(&str, &[&str], u64)] = &[
        (
            "Bud ==> Leaf(|);",
            &["*module Leaf(float size) extends Null"],
            0,
        ),
        (
            "Bud ==> Cylinder(1, |);",
            &["Cylinder()", "*Cylinder(float length, float radius)"],
            1,
        ),
        ("Bud ==> RU(|", &["RU()", "*RU(float angle)"], 0),
        (
            "Bud ==> F(random(0, |1));",
            &["*float random(float a, float b)"],
            1,
        ),
        (
            "Bud ==> F(Math.pow(max(1, 2), |",
            &["*double Math.pow(double base, double exponent)"],
            1,
        ),
        (
            "x:Leaf ::> println(x.older(|));",
            &["*int Leaf.older(int days)"],
            0,
        ),
        ("Bud ==> F(sum(|", &["*sum((* Leaf *)[area])"], 0),
        // No call, a comment, code in braces.
        ("Bud ==> F((1 + |2));", &["F()", "*F(float length)"], 0),
        ("Bud ==> Leaf(1); // F(|", &[], 0),
        ("Bud ==> | Leaf(1);", &[], 0),
    ];
    for (rest, expected, number) in cases {
        let (forms, active) = editor.signatures(&in_run(rest));
        let expected: Vec<String> = expected.iter().map(|form| (*form).to_owned()).collect();
        let is_shown = expected.iter().all(|form| forms.contains(form));
        assert!(is_shown, "{rest}: {forms:?}");
        assert_eq!(forms.is_empty(), expected.is_empty(), "{rest}: {forms:?}");
        assert_eq!(active, *number, "{rest}");
    }
}

#[test]
fn names_are_changed_wherever_they_mean_the_same() {
    let parts = "module Bud(float len);\nstatic float rate = 2;\nstatic float longer(float x) { return x + rate; }\n";
    let mut editor = Editor::with(&[("m.rgg", ""), ("parts.rgg", parts)]);
    let model = |marked: &str| {
        let text = "import static parts.*;\nmodule Leaf(float len);\n\
                    protected void init() [ Axiom ==> Bud(1) Leaf(1); ] // Bud\n\
                    public void run() [\n  b:Bud(x) ==> F(longer(x) * rate) b { float y = x; b[len] += y; println(\"Bud\"); };\n  \
                    Leaf(x), (x > 3) ==> Leaf(x + 1);\n]\n";
        text.replacen(&marked.replace('|', ""), marked, 1)
    };
    let others = &[("parts.rgg", parts)];
    // A module: in both files, not in the remark and the text.
    let renamed = editor
        .rename(&model("b:B|ud(x)"), others, "Sprout")
        .unwrap();
    let expected = format!("{}{parts}", model("|").replacen('|', "", 1))
        .replace("Bud", "Sprout")
        .replace("// Sprout", "// Bud")
        .replace("\"Sprout\"", "\"Bud\"");
    assert_eq!(renamed, expected);
    // A field: not that of the other module. A parameter of a pattern: not that of the other rule.
    let renamed = editor.rename(&model("b[le|n]"), others, "size").unwrap();
    assert!(renamed.contains("b[size]") && renamed.contains("module Bud(float size)"));
    assert!(renamed.contains("module Leaf(float len)"), "{renamed}");
    let renamed = editor.rename(&model("longer(|x)"), others, "z").unwrap();
    assert!(
        renamed.contains("b:Bud(z) ==> F(longer(z) * rate) b { float y = z;"),
        "{renamed}"
    );
    assert!(
        renamed.contains("Leaf(x), (x > 3) ==> Leaf(x + 1)"),
        "{renamed}"
    );
    // A method and a variable of the other file; a label; a local.
    for (marked, new, wanted) in [
        ("F(long|er(x)", "grown", "static float grown(float x)"),
        (
            "* ra|te)",
            "factor",
            "static float factor = 2;\nstatic float longer(float x) { return x + factor; }",
        ),
        (
            "|b:Bud(x)",
            "bud",
            "bud:Bud(x) ==> F(longer(x) * rate) bud { float y = x; bud[len] += y;",
        ),
        ("float |y = x", "step", "float step = x; b[len] += step;"),
    ] {
        let renamed = editor.rename(&model(marked), others, new).unwrap();
        assert!(renamed.contains(wanted), "{marked}: {renamed}");
    }
}

#[test]
fn a_renaming_that_would_change_the_model_is_refused() {
    let mut editor = Editor::with(&[("m.rgg", MODEL)]);
    let fine = in_run("x:Leaf(s), (s > k) ==> F(k) x;");
    let at = |marked: &str| fine.replacen(&marked.replace('|', ""), marked, 1);
    for (marked, new, why) in [
        ("F(|k)", "F", "has a meaning in the language"),
        ("F(|k)", "for", "has a meaning in the language"),
        ("F(|k)", "s", "stands in m.rgg already, at line 7"),
        ("F(|k)", "2k", "is no name"),
        ("F(|k)", "", "is no name"),
        ("=> |F(k)", "Sprout", "no name that the model declares"),
    ] {
        let told = editor.rename(&at(marked), &[], new).unwrap_err();
        assert!(told.contains(why), "{marked} to `{new}`: {told}");
    }
    let broken = in_run("Bud ==> F(|k;");
    let told = editor.rename(&broken, &[], "z").unwrap_err();
    assert!(told.contains("mend the errors"), "{told}");
    let place = editor.change_to("m.rgg", &at("F(|k)"));
    let range = editor.ask("textDocument/prepareRename", place.clone());
    assert_eq!(
        range["end"]["character"],
        range["start"]["character"].as_u64().unwrap() + 1
    );
    let mut params = place;
    params["context"] = json!({ "includeDeclaration": false });
    let uses = editor.ask("textDocument/references", params.clone());
    assert_eq!(uses.as_array().unwrap().len(), 2, "{uses}");
    params["context"]["includeDeclaration"] = true.into();
    let uses = editor.ask("textDocument/references", params);
    assert_eq!(uses.as_array().unwrap().len(), 3, "{uses}");
}

/// Every name of the outline, nested ones included, with its place.
fn names(outline: &Value, found: &mut Vec<(String, Value)>) {
    for symbol in outline.as_array().into_iter().flatten() {
        let name = symbol["name"].as_str().unwrap().to_owned();
        found.push((name, symbol["selectionRange"]["start"].clone()));
        names(&symbol["children"], found);
    }
}

#[test]
fn every_name_of_the_course_can_be_changed_and_the_model_stays_as_it_was() {
    let course = Path::new(env!("CARGO_MANIFEST_DIR")).join("examples/course");
    let mut editor = Editor::with(&[("m.rgg", "")]);
    let mut models: Vec<_> = std::fs::read_dir(course)
        .unwrap()
        .map(|e| e.unwrap().path())
        .collect();
    models.retain(|path| path.extension().is_some_and(|suffix| suffix == "rgg"));
    models.sort();
    let (mut n_renamed, mut kept) = (0, vec![]);
    for path in &models {
        editor.change("m.rgg", &std::fs::read_to_string(path).unwrap());
        let document = json!({ "uri": editor.uri("m.rgg") });
        let outline = editor.ask(
            "textDocument/documentSymbol",
            json!({ "textDocument": document }),
        );
        let mut found = vec![];
        names(&outline, &mut found);
        for (name, place) in found {
            let params =
                json!({ "textDocument": document, "position": place, "newName": "somethingNew" });
            let answer = editor.request("textDocument/rename", params);
            match answer["error"]["message"].as_str() {
                None => n_renamed += 1,
                Some(why) => kept.push(format!("{}: {name}: {why}", path.display())),
            }
        }
    }
    assert!(
        models.len() > 30 && n_renamed > 100,
        "{n_renamed} names of {} models",
        models.len()
    );
    assert_eq!(kept, Vec::<String>::new());
}
