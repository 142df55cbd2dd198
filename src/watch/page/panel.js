// The settings beside the picture: growth, light, the model's numbers; and what was done.

const $ = (id) => document.getElementById(id);

const PHASES = [
  ['read', 'Reading'], ['derive', 'Growing'], ['scene', 'Drawing'], ['accel', 'Building'], ['prepare', 'Preparing'],
  ['render', 'Rendering'], ['write', 'Writing'],
];
const WORK = [
  ['checks', 'Models checked'], ['growths', 'Growths'], ['steps', 'Steps of growth'], ['kept_steps', 'Steps kept'], ['drawings', 'Drawings'],
  ['accels', 'Structures built'], ['kept_prototypes', 'Prototypes kept'], ['scenes', 'Scenes'], ['solutions', 'Solutions'], ['views', 'Views'],
];

const seconds = (s) => s >= 100 ? `${Math.round(s)} s` : s >= 1 ? `${s.toFixed(1)} s` : `${Math.round(1000 * s)} ms`;

/** The settings. `wish` is what the page asks for; `send` asks for it. */
export function panel({ wish, send, post, tell, element }) {
  const set = (key, text) => {
    wish.options[key] = text;
    send();
  };

  // ── growth ──
  const [step, stepNumber] = [$('step'), $('step-number')];
  const setStep = (text) => {
    if (!/^\d{1,9}$/.test(text)) return;
    step.value = stepNumber.value = text;
    set('steps', String(Number(text)));
  };
  step.addEventListener('input', () => setStep(step.value));
  step.addEventListener('change', () => widen(Number(step.value)));
  stepNumber.addEventListener('change', () => {
    widen(Number(stepNumber.value));
    setStep(stepNumber.value);
  });
  const widen = (value) => {
    step.max = Math.max(10, Math.ceil(1.5 * value), value === Number(step.max) ? 2 * value : Number(step.max));
  };
  const showStep = (state) => {
    const text = state.options.steps?.text;
    if (text === undefined || wish.options.steps !== undefined || step.dataset.base === text) return;
    step.dataset.base = text;
    step.max = Math.max(10, 2 * Number(text));
    step.value = stepNumber.value = text;
  };

  // ── choices ──
  const choose = (name, apply) => {
    $(name).addEventListener('change', (event) => apply(event.target.value));
  };
  const check = (name, value) => {
    const input = document.querySelector(`input[name="${name}"][value="${value}"]`);
    if (input && !input.checked) input.checked = true;
  };
  choose('renderer', (value) => set('renderer', value));
  choose('quality', (value) => set('quality', value));
  const [azimuth, elevation] = [$('azimuth'), $('elevation')];
  const showSun = () => {
    $('azimuth-shown').textContent = `${azimuth.value}°`;
    $('elevation-shown').textContent = `${elevation.value}°`;
  };
  const placeSun = () => {
    showSun();
    set('sun', `${azimuth.value},${elevation.value}`);
  };
  choose('sun', (value) => {
    $('sun-place').hidden = value !== 'at';
    if (value === 'at') placeSun();
    else set('sun', value);
  });
  azimuth.addEventListener('input', placeSun);
  elevation.addEventListener('input', placeSun);
  const showChoices = (state) => {
    const { renderer, quality, sun } = state.options;
    if (renderer && wish.options.renderer === undefined) check('renderer', renderer.text);
    if (quality && wish.options.quality === undefined) check('quality', quality.text);
    if (sun && wish.options.sun === undefined) {
      const isPlaced = sun.text !== 'auto' && sun.text !== 'none';
      check('sun', isPlaced ? 'at' : sun.text);
      $('sun-place').hidden = !isPlaced;
      if (isPlaced) [azimuth.value, elevation.value] = sun.text.split(',').map(Number);
      showSun();
    }
  };

  // ── numbers ──
  const rows = new Map();
  let numbersShown = '';

  const range = (number) => {
    const value = Number(number.text);
    const far = value === 0 ? 1 : 2 * Math.abs(value);
    if (number.is_whole) {
      const end = Math.max(10, far);
      return { min: value < 0 ? -end : 0, max: end, step: 1 };
    }
    const digits = Math.floor(Math.log10(far)) - 2;
    return { min: value > 0 ? 0 : -far, max: value < 0 ? 0 : far, step: Number(`1e${digits}`) };
  };

  const change = (id, text) => {
    const row = rows.get(id);
    if (!Number.isFinite(Number(text)) || text === '') return;
    if (Number(text) === Number(row.number.text)) delete wish.constants[id];
    else wish.constants[id] = row.number.is_whole ? String(Math.round(Number(text))) : String(Number(text));
    mark();
    send();
  };

  const mark = () => {
    for (const [id, row] of rows) row.box.classList.toggle('changed', id in wish.constants);
    $('number-actions').hidden = Object.keys(wish.constants).length === 0;
  };

  const numberRow = (number, index, isAlone) => {
    const box = element('div', 'row');
    const label = element('label', '', isAlone ? number.name : number.id);
    label.title = number.remark ? `${number.id}: ${number.remark}` : number.id;
    label.htmlFor = `number-${index}`;
    const slider = element('input');
    const field = element('input');
    const bounds = range(number);
    Object.assign(slider, { type: 'range', id: `number-${index}`, ...bounds });
    Object.assign(field, { type: 'number', step: number.is_whole ? 1 : 'any' });
    field.setAttribute('aria-label', `${number.name}, as a number`);
    if (number.remark) slider.setAttribute('aria-description', number.remark);
    slider.value = field.value = wish.constants[number.id] ?? number.text;
    slider.addEventListener('input', () => { field.value = slider.value; change(number.id, slider.value); });
    field.addEventListener('change', () => { slider.value = field.value; change(number.id, field.value); });
    box.append(label, slider, field);
    rows.set(number.id, { box, slider, field, number });
    return box;
  };

  const showNumbers = (state) => {
    const text = JSON.stringify(state.constants);
    if (text === numbersShown) return;
    numbersShown = text;
    // What the file says by now is no wish any more. What it lacks may be half typed, and come back.
    const known = new Map(state.constants.map((number) => [number.id, number]));
    let isLess = false;
    for (const [id, wanted] of Object.entries(wish.constants)) {
      if (known.has(id) && Number(known.get(id).text) === Number(wanted)) {
        delete wish.constants[id];
        isLess = true;
      }
    }
    const focused = document.activeElement?.id;
    rows.clear();
    const names = state.constants.map((number) => number.name);
    const isAlone = (name) => names.indexOf(name) === names.lastIndexOf(name);
    const made = state.constants.map((number, index) => numberRow(number, index, isAlone(number.name)));
    $('number-rows').replaceChildren(...made);
    $('numbers').hidden = made.length === 0;
    if (focused?.startsWith('number-')) $(focused)?.focus();
    mark();
    if (isLess) send();
  };

  $('revert').addEventListener('click', () => {
    wish.constants = {};
    for (const { slider, field, number } of rows.values()) slider.value = field.value = number.text;
    mark();
    send();
  });
  $('write').addEventListener('click', async () => {
    const answer = await post('/write', wish);
    if (!answer) tell('not connected');
    else if (answer.ok) tell(`written into ${await answer.text()}`);
    else tell(await answer.text());
  });

  // ── what was done ──
  const cell = (tag, text, className) => element(tag, className, text);
  const line = (name, ...cells) => {
    const row = element('tr');
    row.append(cell('th', name), ...cells);
    return row;
  };
  const showDone = (state) => {
    const { frame } = state;
    const parts = [];
    if (frame) {
      parts.push(frame.samples ? `${frame.samples} of ${state.options.samples?.text ?? '?'} samples` : 'a draft');
      if (frame.error !== null) parts.push(`estimated error ${(100 * frame.error).toPrecision(2)} %`);
      parts.push(`${frame.width} × ${frame.height}`);
    }
    $('result').textContent = parts.join(', ');
    const longest = Math.max(1e-9, ...PHASES.map(([key]) => state.seconds[key]));
    const made = PHASES.filter(([key]) => state.seconds[key] >= 0.0005).map(([key, name]) => {
      const bar = element('td', 'bar');
      const inside = element('span');
      inside.style.width = `${100 * state.seconds[key] / longest}%`;
      bar.append(inside);
      return line(name, bar, cell('td', seconds(state.seconds[key])));
    });
    $('phases').replaceChildren(...made);
    $('work').replaceChildren(...WORK.map(([key, name]) => line(name, cell('td', String(state.work[key])))));
  };

  return {
    show(state) {
      showStep(state);
      showChoices(state);
      showNumbers(state);
      showDone(state);
    },
  };
}
