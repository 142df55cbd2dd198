// Moving the camera: a view is { eye, target, up, fov }, points as [x, y, z] in metres, the angle of view in degrees.

const add = (a, b) => a.map((x, i) => x + b[i]);
const sub = (a, b) => a.map((x, i) => x - b[i]);
const times = (a, k) => a.map((x) => x * k);
const dot = (a, b) => a.reduce((sum, x, i) => sum + x * b[i], 0);
const cross = (a, b) => [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];
const length = (a) => Math.sqrt(dot(a, a));
const unit = (a) => times(a, 1 / (length(a) || 1));

// A view never comes nearer to the axis of its up direction than this, in degrees.
const POLE = 1;
const RADIANS = Math.PI / 180;

// Right and up in the picture, and towards the eye.
function frame(view) {
  const back = unit(sub(view.eye, view.target));
  const right = unit(cross(view.up, back));
  return { right, up: cross(back, right), back };
}

// v turned about a unit axis.
function turned(v, axis, angle) {
  const [sin, cos] = [Math.sin(angle), Math.cos(angle)];
  const part = times(axis, dot(axis, v) * (1 - cos));
  return add(add(times(v, cos), times(cross(axis, v), sin)), part);
}

/** The view after the eye has gone round the target, to the right and upwards by so many degrees. */
export function orbit(view, right, upward) {
  const axis = unit(view.up);
  const out = sub(view.eye, view.target);
  const height = Math.asin(Math.max(-1, Math.min(1, dot(unit(out), axis)))) / RADIANS;
  const next = Math.max(POLE - 90, Math.min(90 - POLE, height + upward));
  const risen = turned(out, frame(view).right, (height - next) * RADIANS);
  return { ...view, eye: add(view.target, turned(risen, axis, right * RADIANS)) };
}

/** The view moved along the picture, by parts of its height. */
export function pan(view, right, upward) {
  const { right: x, up: y } = frame(view);
  const scale = 2 * length(sub(view.eye, view.target)) * Math.tan(view.fov * RADIANS / 2);
  const move = add(times(x, right * scale), times(y, upward * scale));
  return { ...view, eye: add(view.eye, move), target: add(view.target, move) };
}

/** The view from another distance: 0.5 is twice as near. */
export function zoom(view, factor) {
  const out = sub(view.eye, view.target);
  const kept = Math.max(1e-4, Math.min(1e6, length(out) * factor)) / (length(out) || 1);
  return { ...view, eye: add(view.target, times(out, kept)) };
}

/** Lets `stage` be dragged, pinched, wheeled and keyed. `get` gives the view, `set` takes another, `home` resets it. */
export function steer(stage, get, set, home) {
  const fingers = new Map();
  const move = (change) => { const view = get(); if (view) set(change(view)); };
  const middle = () => {
    const all = [...fingers.values()];
    const x = all.reduce((sum, p) => sum + p.x, 0) / all.length;
    const y = all.reduce((sum, p) => sum + p.y, 0) / all.length;
    const spread = all.length < 2 ? 0 : Math.hypot(all[0].x - all[1].x, all[0].y - all[1].y);
    return { x, y, spread };
  };
  stage.addEventListener('pointerdown', (event) => {
    if (event.pointerType === 'mouse' && event.button > 2) return;
    fingers.set(event.pointerId, { x: event.clientX, y: event.clientY });
    stage.setPointerCapture(event.pointerId);
    stage.classList.add('dragging');
    stage.focus({ preventScroll: true });
    event.preventDefault();
  });
  stage.addEventListener('pointermove', (event) => {
    if (!fingers.has(event.pointerId)) return;
    const before = middle();
    fingers.set(event.pointerId, { x: event.clientX, y: event.clientY });
    const after = middle();
    const height = stage.clientHeight || 1;
    const [dx, dy] = [(after.x - before.x) / height, (after.y - before.y) / height];
    const pans = event.shiftKey || (event.buttons & 6) !== 0 || fingers.size > 1;
    move((view) => {
      const moved = pans ? pan(view, -dx, dy) : orbit(view, -dx * 180, dy * 180);
      return before.spread > 0 && after.spread > 0 ? zoom(moved, before.spread / after.spread) : moved;
    });
  });
  const lift = (event) => {
    fingers.delete(event.pointerId);
    if (fingers.size === 0) stage.classList.remove('dragging');
  };
  stage.addEventListener('pointerup', lift);
  stage.addEventListener('pointercancel', lift);
  stage.addEventListener('contextmenu', (event) => event.preventDefault());
  stage.addEventListener('wheel', (event) => {
    event.preventDefault();
    const lines = event.deltaMode === 1 ? 16 : 1;
    move((view) => zoom(view, Math.exp(Math.max(-200, Math.min(200, event.deltaY * lines)) / 500)));
  }, { passive: false });
  const keys = {
    ArrowLeft: (view, shift) => shift ? pan(view, -.05, 0) : orbit(view, -5, 0),
    ArrowRight: (view, shift) => shift ? pan(view, .05, 0) : orbit(view, 5, 0),
    ArrowUp: (view, shift) => shift ? pan(view, 0, .05) : orbit(view, 0, 5),
    ArrowDown: (view, shift) => shift ? pan(view, 0, -.05) : orbit(view, 0, -5),
    '+': (view) => zoom(view, 1 / 1.1),
    '=': (view) => zoom(view, 1 / 1.1),
    '-': (view) => zoom(view, 1.1),
  };
  stage.addEventListener('keydown', (event) => {
    if (event.ctrlKey || event.metaKey || event.altKey) return;
    if (event.key === '0' || event.key === 'Home') home();
    else if (keys[event.key]) move((view) => keys[event.key](view, event.shiftKey));
    else return;
    event.preventDefault();
  });
}
