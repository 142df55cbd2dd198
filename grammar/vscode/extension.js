// Starts `understory lsp` for `.rgg` files. Highlighting works without it.
const vscode = require("vscode");

let client;

async function activate() {
  let library;
  try {
    library = require("vscode-languageclient/node");
  } catch {
    // `npm install` was not run in this folder: highlighting only.
    return;
  }
  const command = vscode.workspace.getConfiguration("understory").get("path");
  const server = { command, args: ["lsp"], transport: library.TransportKind.stdio };
  const options = { documentSelector: [{ language: "rgg" }] };
  client = new library.LanguageClient("understory", "understory", server, options);
  try {
    await client.start();
  } catch (error) {
    vscode.window.showWarningMessage(`understory: cannot start \`${command} lsp\`: ${error.message}`);
  }
}

function deactivate() {
  return client?.stop();
}

module.exports = { activate, deactivate };
