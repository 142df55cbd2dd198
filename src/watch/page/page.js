// The page of `understory watch`. The server sends the whole state whenever it changes; the page sends one wish.

import { steer } from '/orbit.js';
import { panel } from '/panel.js';

const $ = (id) => document.getElementById(id);
const wish = { options: {}, constants: {} };
let state = null;

// ── wishes: the newest one, one at a time ──

let isSending = false;
let isWaiting = false;

async function send() {
  if (isSending) { isWaiting = true; return; }
  isSending = true;
  isWaiting = false;
  const answer = await post('/wish', wish);
  if (answer && !answer.ok) tell(await answer.text());
  isSending = false;
  if (isWaiting) send();
}

async function post(path, body) {
  try {
    const headers = { 'Content-Type': 'application/json' };
    return await fetch(path, { method: 'POST', headers, body: JSON.stringify(body) });
  } catch {
    return null;
  }
}

let toldTimer = 0;
function tell(text) {
  $('told').textContent = text;
  clearTimeout(toldTimer);
  toldTimer = setTimeout(() => { $('told').textContent = ''; }, 6000);
}

// ── the camera ──

let view = null;

function setView(next) {
  view = next;
  const text = (point) => point.map((x) => String(Number(x.toPrecision(9)))).join(',');
  wish.options.eye = text(next.eye);
  wish.options.target = text(next.target);
  send();
}

function home() {
  view = null;
  delete wish.options.eye;
  delete wish.options.target;
  send();
}

steer($('stage'), () => view ?? state?.view, setView, home);
$('home').addEventListener('click', home);

// ── pictures ──

let shown = 0;
let isFetching = false;

async function show() {
  const frame = state?.frame;
  if (!frame || frame.number <= shown || isFetching) return;
  isFetching = true;
  try {
    const answer = await fetch(`/frame/${frame.number}`);
    if (answer.ok) {
      const url = URL.createObjectURL(await answer.blob());
      const next = new Image();
      next.src = url;
      await next.decode();
      const picture = $('picture');
      const old = picture.src;
      picture.src = url;
      picture.alt = `Picture of ${state.name}`;
      picture.hidden = false;
      $('waiting').hidden = true;
      $('stage').dataset.frame = frame.number;
      $('stage').dataset.final = frame.is_final;
      if (old.startsWith('blob:')) URL.revokeObjectURL(old);
    }
    // A picture that is no longer there has been followed by a newer one.
    shown = frame.number;
  } catch {
    // The server is gone, or the picture is broken: the next one will do.
  }
  isFetching = false;
  if (state.frame.number > shown) show();
}

// ── what is being done ──

const WORDS = {
  reading: 'Reading', growing: 'Growing', drawing: 'Drawing', 'building the scene': 'Building', preparing: 'Preparing',
  rendering: 'Rendering',
};

function showActivity() {
  const { activity, frame, progress } = state;
  const busy = activity.busy;
  const kind = busy ? 'busy' : activity;
  $('dot').className = kind;
  const percent = busy && progress !== null ? ` ${Math.round(100 * progress)} %` : '';
  $('activity').textContent = busy ? `${WORDS[busy] ?? busy}${percent}`
    : kind === 'done' ? 'Finished' : 'Waiting for a change';
  $('stage').classList.toggle('failed', state.problems.some((problem) => !problem.is_warning));
  $('stage').setAttribute('aria-busy', Boolean(busy));
  $('progress').classList.toggle('on', Boolean(busy) && progress !== null);
  $('progress').firstElementChild.style.width = `${100 * (progress ?? 0)}%`;
  const save = $('save');
  save.setAttribute('aria-disabled', !(frame && frame.is_final));
  save.download = `${state.name.replace(/\.[^.]*$/, '')}.png`;
  document.title = `${kind === 'failed' ? '✗ ' : ''}${state.name} – understory`;
}

// ── what is wrong ──

let problemsShown = '';

function showProblems() {
  const text = JSON.stringify(state.problems);
  if (text === problemsShown) return;
  problemsShown = text;
  const box = $('problems');
  box.hidden = state.problems.length === 0;
  box.replaceChildren(...state.problems.map(problemElement));
}

function element(tag, className, text) {
  const made = document.createElement(tag);
  if (className) made.className = className;
  if (text !== undefined) made.textContent = text;
  return made;
}

function problemElement(problem) {
  const box = element('article', problem.is_warning ? 'problem warning' : 'problem');
  box.append(element('h3', '', problem.message));
  const place = problem.place;
  if (place) {
    const name = `${place.name}:${place.line}:${place.column}`;
    const link = element('button', 'place', name);
    link.type = 'button';
    link.title = state.has_editor ? 'Open in the editor' : 'Copy the place (start with --editor to open it)';
    link.addEventListener('click', () => openPlace(place, name));
    const characters = Array.from(place.text);
    const part = (from, to) => characters.slice(from, to).join('');
    const code = element('pre');
    code.tabIndex = 0;
    code.append(part(0, place.from), element('mark', '', part(place.from, place.to) || ' '), part(place.to));
    if (place.label) code.append('\n', element('span', 'label', place.label));
    box.append(link, code);
    // On a narrow screen the place may be out of sight.
    requestAnimationFrame(() => {
      const [inside, outside] = [code.querySelector('mark'), code].map((e) => e.getBoundingClientRect());
      if (inside.right > outside.right) code.scrollLeft += inside.left - outside.left - outside.width / 3;
    });
  }
  for (const note of problem.notes) box.append(element('p', '', note));
  return box;
}

async function openPlace(place, name) {
  if (!state.has_editor) {
    await copy(name, 'place copied');
    return;
  }
  const answer = await post('/open', { file: place.file, line: place.line, column: place.column });
  tell(answer?.ok ? `${name} opened` : answer ? await answer.text() : 'not connected');
}

// ── the command ──

async function copy(text, told) {
  try {
    await navigator.clipboard.writeText(text);
    tell(told);
  } catch {
    getSelection().selectAllChildren($('command'));
    tell('selected: copy it with Ctrl-C');
  }
}

$('copy').addEventListener('click', () => copy(state?.command ?? '', 'command copied'));

// ── the settings ──

const settings = panel({ wish, send, post, tell, element });

// ── what the server says ──

const events = new EventSource('/events');

events.addEventListener('state', (event) => {
  state = JSON.parse(event.data);
  $('name').textContent = state.name;
  if (state.command) $('command').textContent = state.command;
  const [width, height] = (state.options.size?.text ?? '3x2').split('x').map(Number);
  document.querySelector('.frame').style.setProperty('--aspect', width / height);
  showActivity();
  showProblems();
  settings.show(state);
  show();
});

events.addEventListener('error', () => {
  $('dot').className = 'failed';
  $('activity').textContent = 'Not connected';
});
// A server that was started again begins to count its pictures anew, and knows of no wish.
events.addEventListener('open', () => {
  shown = 0;
  send();
});
