/**
 * Number boxes take a number as a whole: what is typed or pasted stays as it is, and is one number
 * after a pause, or with Enter, Tab or a click elsewhere. What is none is refused with a hint, and
 * the number from before comes back, as it does with Escape.
 *
 * Left alone, viser's boxes send every keystroke and are written again with the number so far, so
 * that a decimal point or an exponent gets lost and the digits after it make another number. Here
 * their keystrokes never reach them; `holder` finds what would have received the number.
 */
(() => {
  "use strict";
  window.paminsaNumberFields?.stop();
  const BOX = "input.mantine-NumberInput-input";
  const CONTROL = ".mantine-NumberInput-control";
  const HINT_TIME = 6000;
  const PAUSE = 1000;
  const stopped = new AbortController();

  // --- text to number -----------------------------------------------------------------------
  const NUMBER = /^[+-]?(\d+\.?\d*|\.\d+)(e[+-]?\d+)?$/i;
  const AMBIGUOUS = /^[+-]?[1-9]\d{0,2},\d{3}(e[+-]?\d+)?$/i;
  const parse = (text) => {
    let plain = text.trim().replace(/^\u2212/, "-");
    if (AMBIGUOUS.test(plain))
      return { problem: `${plain} may be a thousand or a fraction: write ${plain.replace(",", ".")} or ${plain.replace(",", "")}` };
    if (!plain.includes(".")) plain = plain.replace(",", ".");
    const number = NUMBER.test(plain) ? Number(plain) : NaN;
    if (Number.isFinite(number)) return { number };
    return { problem: `“${text.trim()}” is not a number: write 33.5, 33,5 or 3.35e1` };
  };

  // --- the component behind a box -----------------------------------------------------------
  // React keeps two versions of each; the one that is shown is found from the root down.
  const current = (fiber) => {
    if (!fiber.return) return fiber.stateNode?.current;
    let child = current(fiber.return)?.child;
    while (child && child !== fiber && child !== fiber.alternate) child = child.sibling;
    return child;
  };
  const holder = (field) => {
    const key = Object.keys(field ?? {}).find((name) => name.startsWith("__reactFiber$"));
    for (let fiber = key && field[key]; fiber; fiber = fiber.return) {
      const props = fiber.memoizedProps;
      const found = props && "decimalScale" in props && !("onValueChange" in props);
      if (found && typeof props.onChange === "function") {
        return current(fiber)?.memoizedProps ?? props;
      }
    }
    return undefined;
  };

  // --- hint ---------------------------------------------------------------------------------
  let bubble = null;
  let fading = 0;
  const hideHint = () => {
    clearTimeout(fading);
    bubble?.remove();
    bubble = null;
  };
  const showHint = (field, text) => {
    hideHint();
    bubble = document.createElement("div");
    bubble.className = "pv-field-hint";
    bubble.setAttribute("role", "alert");
    bubble.textContent = text;
    const box = field.getBoundingClientRect();
    bubble.style.top = `${box.bottom + 4}px`;
    bubble.style.right = `${Math.max(4, window.innerWidth - box.right)}px`;
    document.body.appendChild(bubble);
    fading = setTimeout(hideHint, HINT_TIME);
  };

  // --- editing ------------------------------------------------------------------------------
  let edit = null;
  const isEdited = ({ field, dirty }) =>
    dirty || field.selectionStart !== 0 || field.selectionEnd !== field.value.length;

  const begin = (field) => {
    const own = Object.getOwnPropertyDescriptor(field, "value");
    const shown = own ?? Object.getOwnPropertyDescriptor(HTMLInputElement.prototype, "value");
    edit = { field, own, shown, held: field.value, dirty: false, fresh: true, previewed: false };
    const { field: mine } = edit;
    // The page writes the value that holds, and again with every frame of a motion that plays.
    Object.defineProperty(field, "value", {
      configurable: true,
      enumerable: true,
      get: () => shown.get.call(mine),
      set: (text) => {
        edit.held = text;
        if (isEdited(edit)) return;
        shown.set.call(mine, text);
        mine.select();
      },
    });
    field.select();
  };
  let pause = 0;
  const take = (number) => holder(edit.field)?.onChange(number);
  const preview = () => {
    const { number } = parse(edit?.dirty ? edit.field.value : "");
    if (number === undefined) return;
    const { value } = holder(edit.field) ?? {};
    if (!edit.previewed) edit.before = value;
    edit.previewed = true;
    // The page does not write a box that shows the number as it would itself.
    if (number !== value) edit.held = edit.field.value;
    take(number);
  };
  const close = () => {
    clearTimeout(pause);
    Object.assign(edit, { dirty: false, previewed: false, fresh: true });
    edit.shown.set.call(edit.field, edit.held);
    if (document.activeElement === edit.field) edit.field.select();
  };
  const cancel = () => {
    const { previewed, before } = edit;
    close();
    if (previewed) take(before);
  };
  const commit = () => {
    hideHint();
    if (!edit.dirty) return;
    const text = edit.field.value;
    const { number, problem } = parse(text);
    if (problem) {
      cancel();
      if (text.trim() !== "") showHint(edit.field, problem);
    } else {
      close();
      take(number);
    }
  };
  const end = () => {
    if (!edit) return;
    commit();
    const { field, own, held } = edit;
    edit = null;
    if (own) Object.defineProperty(field, "value", own);
    else delete field.value;
    if (field.value !== held) field.value = held;
  };
  const step = (direction) => {
    const { value, step: size, min = -Infinity, max = Infinity } = holder(edit.field);
    const typed = edit.dirty ? parse(edit.field.value).number : undefined;
    const from = typed ?? value;
    close();
    edit.field.select();
    take(Math.min(Math.max(Number((from + direction * (size ?? 1)).toFixed(9)), min), max));
  };

  const KEYS = {
    Enter: () => { commit(); edit.field.select(); },
    Escape: () => { cancel(); edit.field.select(); },
    ArrowUp: () => step(1),
    ArrowDown: () => step(-1),
  };
  const HANDLERS = {
    focusin: (event) => {
      if (edit?.field === event.target || !event.target.matches?.(BOX)) return;
      end();
      if (event.target.readOnly || !holder(event.target)) return;
      begin(event.target);
      event.stopPropagation(); // a box that knows of it puts the caret somewhere with every number
    },
    focusout: (event) => {
      if (edit?.field !== event.target) return;
      end();
      event.stopPropagation(); // the box would limit its number to the range, without a word
    },
    input: (event) => {
      if (edit?.field !== event.target) return;
      edit.dirty = true;
      hideHint();
      clearTimeout(pause);
      pause = setTimeout(preview, PAUSE);
      event.stopPropagation();
    },
    change: (event) => {
      if (edit?.field === event.target) event.stopPropagation();
    },
    keydown: (event) => {
      if (edit?.field !== event.target || event.isComposing || event.key === "Tab") return;
      const erases = event.key === "Backspace" || event.key === "Delete";
      if ((event.ctrlKey || event.metaKey) && !erases) return;
      event.stopPropagation();
      if (!KEYS[event.key]) return;
      event.preventDefault();
      KEYS[event.key]();
    },
    pointerdown: (event) => {
      const control = event.target.closest?.(CONTROL);
      if (!edit || !control?.closest(".mantine-NumberInput-root")?.contains(edit.field)) return;
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
    document.addEventListener(kind, handle, { capture: true, signal: stopped.signal });

  const stop = () => {
    end();
    hideHint();
    stopped.abort();
  };
  const works = () => Boolean(holder(document.querySelector(BOX)));
  window.paminsaNumberFields = { stop, works, parse };
})();
