// Checks the highlighting with the engine that VS Code uses. See README.md.
const fs = require("fs");
const path = require("path");
const oniguruma = require("vscode-oniguruma");
const textmate = require("vscode-textmate");

// A text, and what its words must be (the end of the innermost scope's name, without `.rgg`).
const CASES = [
  ["module Leaf(float size) extends Null;", { module: "type.module", Leaf: "name.type.module", float: "type.primitive", Null: "inherited-class" }],
  ["a:Bud(x), (x > 1) ==> F(x, 0.05) [RU(30) Bud(x*2)];", { a: "label", Bud: "name.type", "==>": "arrow", F: "turtle", "0.05": "numeric", RU: "turtle" }],
  ["x:A ::> x[age] :+= 1;", { "::>": "arrow", ":+=": "deferred", A: "variable.other" }],
  ["A ==>> ;", { "==>>": "arrow" }],
  ["float s = sum((* Leaf *)[area]); // all", { sum: "aggregate", "(*": "query", "*)": "query", "// all": "double-slash" }],
  ["Sphere(1).(setShader(GREEN))", { Sphere: "geometry", GREEN: "support.constant", setShader: "name.function" }],
  ["A -minDescendants-> B", { minDescendants: "constant.edge" }],
  ["if (a == null) { return Math.sqrt(2e-3f); }", { if: "control", null: "language", return: "control", Math: "class", sqrt: "function", "2e-3f": "numeric" }],
  ["println(\"F(1) ==> \\\" /* no */\");", { println: "support.function", "F(1) ==> ": "quoted.double", '\\"': "escape" }],
  ["import static java.lang.Math.*;", { import: "import", "java.lang.Math.*": "namespace" }],
  ["for (int i : 1:n) (F0 RH(137.5))", { for: "control", F0: "turtle", RH: "turtle", "137.5": "numeric" }],
  ["F1 Fx aF Blattgröße(2)", { F1: "variable.other", Fx: "variable.other", aF: "variable.other", Blattgröße: "name.type" }],
];

const name = (scope) => scope.replace(/\.rgg$/, "");

async function main() {
  const wasm = fs.readFileSync(require.resolve("vscode-oniguruma/release/onig.wasm"));
  await oniguruma.loadWASM(wasm.buffer.slice(wasm.byteOffset, wasm.byteOffset + wasm.byteLength));
  const file = path.join(__dirname, "syntaxes", "rgg.tmLanguage.json");
  const registry = new textmate.Registry({
    onigLib: Promise.resolve({
      createOnigScanner: (patterns) => new oniguruma.OnigScanner(patterns),
      createOnigString: (text) => new oniguruma.OnigString(text),
    }),
    loadGrammar: async () => textmate.parseRawGrammar(fs.readFileSync(file, "utf8"), file),
  });
  const grammar = await registry.loadGrammar("source.rgg");
  let nWrong = 0;
  let nChecked = 0;
  for (const [text, wanted] of CASES) {
    const tokens = grammar.tokenizeLine(text, textmate.INITIAL).tokens;
    for (const [word, scope] of Object.entries(wanted)) {
      const found = tokens
        .filter((t) => text.slice(t.startIndex, t.endIndex).trim() === word.trim() || (text.indexOf(word) >= t.startIndex && text.indexOf(word) + word.length <= t.endIndex))
        .map((t) => name(t.scopes[t.scopes.length - 1]));
      const comment = tokens.flatMap((t) => t.scopes.map(name));
      nChecked += 1;
      const fits = found.some((f) => f.endsWith(scope)) || (scope === "double-slash" && comment.some((f) => f.endsWith(scope)));
      if (!fits) {
        nWrong += 1;
        console.log(`${text}\n  \`${word}\` should be ${scope}, is ${found.join(", ") || "no token"}`);
      }
    }
  }
  for (const model of process.argv.slice(2)) {
    // A whole model: no scope may stay open at its end.
    let state = textmate.INITIAL;
    for (const line of fs.readFileSync(model, "utf8").split("\n")) {
      state = grammar.tokenizeLine(line, state).ruleStack;
    }
    nChecked += 1;
    if (state.depth !== 1) {
      nWrong += 1;
      console.log(`${model}: something is still open at the end`);
    }
  }
  console.log(`${nChecked} checked, ${nWrong} wrong`);
  process.exit(nWrong === 0 ? 0 : 1);
}

main();
