/**
 * Number boxes take a number as a whole: what is typed or pasted stays as it is until Enter, Tab, an
 * arrow key or leaving the box, and then is one number. It may be a term, 2*35 or 1/2, and have a unit
 * of the field's kind behind it, 50 mm or 5 cm. What is none is refused with a hint, and the number from
 * before comes back, as it does with Escape.
 *
 * Left alone, viser's boxes send every keystroke and are written again with the number so far, so
 * that a decimal point or an exponent gets lost and the digits after it make another number. Here
 * their keystrokes never reach them. It runs in the head of the page, before there is any box.
 *
 * A number is given to the input and not to the box: viser may replace the box while it is edited,
 * or all of the page when it connects again. What is typed goes on in the new box, or waits for it.
 *
 * A box in a text, `input[data-paminsa-field]`, takes numbers in the same way and sends them as a
 * message of that kind, with its `data-paminsa-value`; `data-paminsa-unit` is its unit.
 */
(() => {
  "use strict";
  const OF_INPUT = "input.mantine-NumberInput-input";
  const IN_TEXT = "input[data-paminsa-field]";
  const BOX = `${OF_INPUT}, ${IN_TEXT}`;
  const ROOT = ".mantine-NumberInput-root";
  const CONTROL = ".mantine-NumberInput-control";
  const HINT_TIME = 6000;
  const RETRY_TIME = 50;
  const MISSING_TIME = 10000; // how long an input may be missing from a page that is connected
  const EMPTY_TIME = 2000; // how long keys wait for a box that nothing was typed into

  // --- text to number -----------------------------------------------------------------------
  // A number, or sums and products of numbers; behind it the field's unit, or one of its kind.
  const NUMBER = /^(\d+\.?\d*|\.\d+)(e[+-]?\d+)?/i;
  const AMBIGUOUS = /(^|[^\d.,])[1-9]\d{0,2},\d{3}(?![\d.,])/;
  const PARTS = /^((?:[^a-zµ°″%]|(?<=[\d.])e(?=[+-]?\d))*)(.*)$/i;
  const KINDS = @KINDS@;
  const plainUnit = (unit) => unit.replace(/[\s·*^]/g, "").replace("²", "2").replace("³", "3");
  /** How many of the field's unit one of the unit typed is; undefined if it is of another kind. */
  const scale = (typed, own) => {
    if (!typed || plainUnit(typed) === plainUnit(own ?? "")) return 1;
    const kind = KINDS.find((each) => own in each && plainUnit(typed) in each);
    return kind && kind[plainUnit(typed)] / kind[own];
  };
  /** The value of a term in numbers, + - * / and brackets; NaN if it is none. */
  const evaluate = (text) => {
    let rest = text;
    const eat = (pattern) => {
      const [found] = rest.match(pattern) ?? [];
      if (found !== undefined) rest = rest.slice(found.length).trimStart();
      return found;
    };
    const factor = () => {
      const sign = eat(/^[+-]/);
      if (sign) return sign === "-" ? -factor() : factor();
      if (!eat(/^\(/)) return Number(eat(NUMBER) ?? NaN);
      const value = sum();
      return eat(/^\)/) ? value : NaN;
    };
    const chain = (part, pattern, combine) => {
      let value = part();
      for (let sign = eat(pattern); sign; sign = eat(pattern)) value = combine(value, sign, part());
      return value;
    };
    const product = () => chain(factor, /^[*/]/, (a, sign, b) => (sign === "*" ? a * b : a / b));
    const sum = () => chain(product, /^[+-]/, (a, sign, b) => (sign === "+" ? a + b : a - b));
    const value = sum();
    return rest ? NaN : value;
  };
  const MOST_TYPED = 200;
  const parse = (text, own) => {
    let [, plain, typed] = text.trim().replaceAll("\u2212", "-").match(PARTS) ?? [];
    const refused = { problem: `“${text.trim()}” is not a number: write 33.5, 33,5, 3.35e1 or 2*16.75` };
    const cutShort = /^e[+-]?$/i.test(typed); // a power of ten, and no unit
    if (!plain?.trim() || cutShort || text.length > MOST_TYPED) return refused;
    plain = plain.trim();
    if (AMBIGUOUS.test(plain))
      return { problem: `${plain} may be a thousand or a fraction: write ${plain.replace(",", ".")} or ${plain.replace(",", "")}` };
    if (!plain.includes(".")) plain = plain.replace(",", ".");
    const number = evaluate(plain);
    if (!Number.isFinite(number)) return refused;
    const times = scale(typed, own);
    if (times === undefined)
      return own ? { problem: `the field is in ${own}, “${typed}” is not` } : refused;
    return { number: times === 1 && NUMBER.test(plain) ? number : Number((times * number).toPrecision(15)) };
  };

  // --- inputs, as viser holds them ----------------------------------------------------------
  const { find } = window.paminsaContext;
  let viewer = null; // viser's own context
  window.paminsaContext.whenFound((context) => { viewer = context; });
  const inputOf = (uuid) => viewer?.useGuiConfig.get(uuid);
  const alike = (type, label) => Object.entries(viewer.useGuiConfig.getAll())
    .filter(([, input]) => input?.type === type && input.props.label === label)
    .map(([uuid]) => uuid);
  const boxesOf = (uuid) => {
    const element = document.getElementById(uuid);
    const part = element?.matches(OF_INPUT) ? element.closest(ROOT) : element;
    return [...(part?.parentElement.querySelectorAll(OF_INPUT) ?? [])];
  };
  /** The place of a box in a text, by what it sends. */
  const placeInText = ({ dataset, ariaLabel }) => ({
    kind: dataset.paminsaField, which: dataset.paminsaValue, unit: dataset.paminsaUnit, label: ariaLabel,
  });
  /** Which input a box belongs to, in words that hold when all inputs are made again. */
  const placeOf = (field) => {
    if (field?.matches(IN_TEXT)) return placeInText(field);
    if (!viewer) return undefined;
    const uuid = find(field, (props) => inputOf(props.uuid) && props.uuid);
    if (!uuid) return undefined;
    const { type, props: { label } } = inputOf(uuid);
    const known = alike(type, label);
    const index = Math.max(boxesOf(uuid).indexOf(field), 0);
    return { uuid, index, type, label, known, number: known.indexOf(uuid) };
  };
  /** The uuid that the input at a place has now; an input made again comes behind the others. */
  const current = ({ uuid, type, label, known, number }) => {
    if (inputOf(uuid)) return uuid;
    const fresh = alike(type, label).filter((each) => !known.includes(each));
    return fresh[Math.min(number, fresh.length - 1)];
  };
  /** The box that is at a place now, if there is one. */
  const boxAt = (place) => {
    if (!place.kind) return boxesOf(current(place))[place.index];
    return [...document.querySelectorAll(IN_TEXT)].find((box) => isSame(placeInText(box), place));
  };
  const isSame = (one, other) => one.kind || other.kind
    ? one.kind === other.kind && one.which === other.which
    : one.index === other.index && current(one) === current(other);
  const unitOf = ({ unit, label }) => unit ?? window.paminsaUnits?.split(label).unit;
  const part = (value, { index }) => (Array.isArray(value) ? value[index] : value);
  const give = (place, number) => {
    if (connected() === false) return false;
    if (place.kind) return Boolean(boxAt(place) && window.paminsa?.send(place.kind, [place.which, number]));
    const uuid = current(place);
    if (!uuid) return false;
    const before = inputOf(uuid).value;
    const value = Array.isArray(before) ? before.with(place.index, number) : number;
    viewer.guiActions.updateGuiProps(uuid, { value }); // which is sent by inputs.js
    return true;
  };

  // --- hint ---------------------------------------------------------------------------------
  let bubble = null;
  let fading = 0;
  const hideHint = () => {
    clearTimeout(fading);
    bubble?.remove();
    bubble = null;
  };
  const showHint = (place, text) => {
    hideHint();
    const box = boxAt(place)?.getBoundingClientRect();
    bubble = document.createElement("div");
    bubble.className = "pv-field-hint";
    bubble.setAttribute("role", "alert");
    bubble.textContent = text;
    bubble.style.top = `${(box?.bottom ?? 0) + 4}px`;
    bubble.style.right = `${box ? Math.max(4, window.innerWidth - box.right) : 4}px`;
    document.body.appendChild(bubble);
    fading = setTimeout(hideHint, HINT_TIME);
  };

  // --- numbers that wait for their input ----------------------------------------------------
  let waiting = []; // {place, number, left: how long the input may still be missing [ms]}
  let retrying = 0;
  const retry = () => {
    retrying = 0;
    waiting = waiting.filter((one) => {
      if (give(one.place, one.number)) return false;
      one.left = connected() === false ? MISSING_TIME : one.left - RETRY_TIME;
      if (one.left <= 0)
        showHint(one.place, `${one.place.label}: ${one.number} was not taken, its box has gone`);
      return one.left > 0;
    });
    if (waiting.length) retrying = setTimeout(retry, RETRY_TIME);
  };
  const take = (place, number) => {
    waiting = waiting.filter((one) => !isSame(one.place, place)); // only the last number counts
    if (give(place, number)) return;
    waiting.push({ place, number, left: MISSING_TIME });
    retrying ||= setTimeout(retry, RETRY_TIME);
  };

  // --- editing ------------------------------------------------------------------------------
  let edit = null;
  let orphan = null; // what was typed into a box that is not there any more: {place, text, caret}
  const isEdited = ({ field, dirty }) =>
    dirty || field.selectionStart !== 0 || field.selectionEnd !== field.value.length;

  const begin = (field) => {
    const place = placeOf(field);
    if (field.readOnly || !place) return false;
    const own = Object.getOwnPropertyDescriptor(field, "value");
    const shown = own ?? Object.getOwnPropertyDescriptor(HTMLInputElement.prototype, "value");
    const mine = { field, place, own, shown, held: field.value, dirty: false, fresh: true };
    edit = mine;
    // The page writes the value that holds, and again with every frame of a motion that plays.
    Object.defineProperty(field, "value", {
      configurable: true,
      enumerable: true,
      get: () => shown.get.call(field),
      set: (text) => {
        mine.held = text;
        if (isEdited(mine)) return;
        shown.set.call(field, text);
        if (document.activeElement === field) field.select(); // it would take the focus
      },
    });
    replaced.observe(document.body, { childList: true, subtree: true });
    return true;
  };
  const close = () => {
    Object.assign(edit, { dirty: false, fresh: true });
    edit.shown.set.call(edit.field, edit.held);
    if (document.activeElement === edit.field) edit.field.select();
  };
  /** Take a text; false if it is refused. */
  const takeText = (place, text) => {
    const { number, problem } = parse(text, unitOf(place));
    if (number !== undefined) take(place, number);
    else if (text.trim() !== "") showHint(place, problem);
    return number !== undefined;
  };
  const commit = () => {
    hideHint();
    if (!edit.dirty) return true;
    const text = edit.field.value;
    close();
    return takeText(edit.place, text);
  };
  const release = () => {
    const { field, own } = edit;
    edit = null;
    replaced.disconnect();
    if (own) Object.defineProperty(field, "value", own);
    else delete field.value;
  };
  const end = () => {
    if (!edit) return;
    commit();
    const { field, held } = edit;
    release();
    if (field.value !== held) field.value = held;
  };
  const step = (direction) => {
    const { props, value } = inputOf(current(edit.place)) ?? {};
    if (!props) return;
    const [min, max] = [part(props.min, edit.place), part(props.max, edit.place)];
    const typed = edit.dirty ? parse(edit.field.value, unitOf(edit.place)).number : undefined;
    const from = typed ?? part(value, edit.place);
    const to = Number((from + direction * (props.step ?? 1)).toFixed(9));
    close();
    edit.field.select();
    take(edit.place, Math.min(Math.max(to, min ?? -Infinity), max ?? Infinity));
  };

  // --- boxes that are replaced while they are edited ----------------------------------------
  const lose = () => {
    const { place, dirty, field } = edit;
    const caret = field.selectionStart ?? field.value.length;
    const mine = { place, text: dirty ? field.value : null, caret };
    orphan = mine;
    setTimeout(() => orphan === mine && mine.text === null && leaveOrphan(), EMPTY_TIME);
    release();
    replaced.observe(document.body, { childList: true, subtree: true });
    adopt();
  };
  const adopt = () => {
    const { place, text, caret } = orphan;
    const field = boxAt(place);
    if (!field || field.readOnly || field.disabled) return;
    orphan = null;
    field.focus({ preventScroll: true }); // which begins to edit it, if the window has the focus
    if (edit?.field !== field && !begin(field)) return;
    if (text === null) return field.select();
    edit.dirty = true;
    edit.shown.set.call(field, text);
    field.setSelectionRange(caret, caret);
  };
  const leaveOrphan = () => {
    const { place, text } = orphan;
    orphan = null;
    if (!edit) replaced.disconnect();
    if (text !== null) takeText(place, text);
  };
  const replaced = new MutationObserver(() => {
    if (orphan) adopt();
    else if (edit && !edit.field.isConnected) lose();
  });
  // Keys that are typed while there is no box.
  const typeOrphan = (event) => {
    const { key } = event;
    if (event.isComposing || event.ctrlKey || event.metaKey) return;
    if (key === "Enter" || key === "Tab") leaveOrphan();
    else if (key === "Escape") orphan.text = null;
    else if (key.length === 1 || key === "Backspace") {
      const { text, caret } = orphan;
      const [kept, added] = key === "Backspace" ? [Math.max(caret - 1, 0), ""] : [caret, key];
      orphan.text = text === null ? added : text.slice(0, kept) + added + text.slice(caret);
      orphan.caret = text === null ? added.length : kept + added.length;
    } else return;
    event.stopPropagation();
    event.preventDefault();
  };

  const isUndo = ({ key, ctrlKey, metaKey, altKey }) =>
    (ctrlKey || metaKey) && !altKey && ["z", "y"].includes(key.toLowerCase());
  /** The box below in a table, which Enter goes to as in a spreadsheet. */
  const below = (field) => {
    const boxes = [...(field.closest("table")?.querySelectorAll(IN_TEXT) ?? [])];
    return boxes.find((box, index) => boxes.indexOf(field) === index - 1);
  };
  const KEYS = {
    Enter: () => {
      if (commit()) (below(edit.field) ?? edit.field).focus();
      edit.field.select();
    },
    Escape: () => { close(); edit.field.select(); },
    ArrowUp: () => step(1),
    ArrowDown: () => step(-1),
  };
  const HANDLERS = {
    focusin: (event) => {
      if (orphan) leaveOrphan();
      if (edit?.field === event.target) return;
      end();
      if (!event.target.matches?.(BOX) || !begin(event.target)) return;
      event.target.select();
      event.stopPropagation(); // a box that knows of it puts the caret somewhere with every number
    },
    focusout: (event) => {
      const field = event.target;
      if (edit?.field !== field) return;
      event.stopPropagation(); // the box would limit its number to the range, without a word
      // Not at once: a box that is taken off the page loses the focus, but nobody has left it.
      queueMicrotask(() => edit?.field === field && (field.isConnected ? end() : lose()));
    },
    input: (event) => {
      const field = event.target;
      if (edit?.field !== field) {
        if (field !== document.activeElement || !field.matches?.(BOX)) return;
        end();
        if (!begin(field)) return;
      }
      edit.dirty = true;
      hideHint();
      event.stopPropagation();
    },
    change: (event) => {
      if (edit?.field === event.target) event.stopPropagation();
    },
    // The box would write a text with a comma itself, with a point and without an `input` event.
    paste: (event) => {
      if (edit?.field === event.target) event.stopPropagation();
    },
    keydown: (event) => {
      if (orphan) return typeOrphan(event);
      if (edit?.field !== event.target || event.isComposing || event.key === "Tab") return;
      const erases = event.key === "Backspace" || event.key === "Delete";
      if (isUndo(event) && !edit.dirty) {
        // The browser has nothing to undo in a box whose number was taken: the page has.
        event.preventDefault();
        event.stopPropagation();
        window.paminsa?.send(event.shiftKey || event.key.toLowerCase() === "y" ? "redo" : "undo", null);
        return;
      }
      if ((event.ctrlKey || event.metaKey) && !erases) return;
      event.stopPropagation();
      if (!KEYS[event.key]) return;
      event.preventDefault();
      KEYS[event.key]();
    },
    pointerdown: (event) => {
      hideHint();
      if (orphan) leaveOrphan();
      const control = event.target.closest?.(CONTROL);
      if (!edit || !control?.closest(ROOT)?.contains(edit.field)) return;
      commit();
      edit.field.select();
    },
    // The first press selects the whole number, to be replaced; the next one puts the caret.
    mousedown: (event) => {
      const field = event.target;
      if (event.button !== 0 || !field.matches?.(BOX)) return;
      field.focus();
      if (edit?.field !== field || !edit.fresh || isEdited(edit)) return;
      edit.fresh = false;
      event.preventDefault();
    },
  };
  for (const [kind, handle] of Object.entries(HANDLERS))
    document.addEventListener(kind, handle, { capture: true });

  const works = () => Boolean(placeOf(document.querySelector(OF_INPUT)));
  /** Whether the server is there; undefined as long as there has been no box to know it from. */
  const connected = () => viewer ? viewer.useGui.get().websocketState === "connected" : undefined;
  window.paminsaNumberFields = { works, parse, connected };
})();
