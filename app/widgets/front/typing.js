/* What is typed counts when Enter or leaving the box ends it.

viser sends every keystroke, and writes into a box while somebody types in it. So its page hears of
a keystroke only at the end, and what it writes until then is kept aside. Escape gives up what was
typed, and so does leaving a number box without a number in it. Arrow keys step from what was typed.
A number that is left is taken once the box has been: as it is left, viser pulls it back to where
its slider ends. A number may be a calculation, and in another unit than the row's: "300+25",
"12.5 in", "(1/3)*2 cm". */
if (!window.typedWhenLeft) {
  window.typedWhenLeft = true;
  const open = new WeakMap();
  const BOXES = ".mantine-NumberInput-root,.mantine-TextInput-root,.mantine-Textarea-root";
  const plain = (box) => Object.getOwnPropertyDescriptor(Object.getPrototypeOf(box), "value");
  const isNumber = (box) => box.closest(".mantine-NumberInput-root");
  const LENGTHS = { mm: 1, cm: 10, m: 1000, in: 25.4, inch: 25.4, '"': 25.4, ft: 304.8 };
  const ANGLES = { "°": 1, deg: 1, rad: 180 / Math.PI };
  const unitsOf = (box) => {
    const row = box.closest(".mantine-Flex-root:has(label)");
    const [, unit] = /\((mm|°)\)/.exec(row ? row.querySelector("label").textContent : "") || [];
    return unit === "mm" ? LENGTHS : unit === "°" ? ANGLES : {};
  };
  /* What a text means in the row's unit; NaN where it means nothing. */
  const valueOf = (text, units) => {
    const left = text.replace(/−/g, "-").replace(/(\d),(?=\d)/g, "$1.")
      .match(/\d+\.?\d*(?:e[+-]?\d+)?|\.\d+|[a-z]+|\S/gi) || [];
    const next = (...signs) => (signs.includes(left[0]) ? left.shift() : "");
    const inUnit = (value) => (Object.hasOwn(units, left[0]) ? value * units[left.shift()] : value);
    const factor = () => {
      if (next("-")) return -factor();
      if (next("+")) return factor();
      if (next("(")) {
        const value = sum();
        return next(")") ? inUnit(value) : NaN;
      }
      return /^[\d.]/.test(left[0] || "") ? inUnit(Number(left.shift())) : NaN;
    };
    const product = () => {
      let value = factor(), sign;
      while ((sign = next("*", "×", "·", "/"))) value = sign === "/" ? value / factor() : value * factor();
      return value;
    };
    const sum = () => {
      let value = product(), sign;
      while ((sign = next("+", "-"))) value += sign === "-" ? -product() : product();
      return value;
    };
    const value = sum();
    return left.length || !isFinite(value) ? NaN : value;
  };
  const refuse = (box, text, units) => {
    const note = document.createElement("div"), { left, bottom } = box.getBoundingClientRect();
    const known = Object.keys(units).filter((unit) => /^[a-z°]+$/.test(unit)).join(", ");
    note.className = "bo-wrong";
    note.setAttribute("role", "alert");
    note.textContent = `“${text}” is no number: type 12.5, 300+25`
      + (known ? ` or a number with one of ${known}.` : ".");
    note.style.top = `${bottom + 4}px`;
    note.style.right = `${Math.max(innerWidth - left - 68, 8)}px`;
    document.body.append(note);
    setTimeout(() => note.remove(), 6000);
  };
  window.bohemiaNumber = (box, unit) => {
    const units = unit === "mm" ? LENGTHS : unit === "°" ? ANGLES : {};
    const text = box.value.trim(), value = valueOf(text, units);
    if (!isFinite(value)) refuse(box, text, units);
    return value;
  };
  const begin = (box) => {
    if (open.has(box)) return;
    const { get } = plain(box);
    const typed = { own: Object.getOwnPropertyDescriptor(box, "value"), last: get.call(box) };
    open.set(box, typed);
    Object.defineProperty(box, "value", {
      configurable: true,
      get() { return get.call(box); },
      set(value) { if (String(value) !== get.call(box)) typed.last = String(value); },
    });
  };
  const end = (box, taken) => {
    const typed = open.get(box);
    if (!typed) return;
    const { get, set } = plain(box);
    const typedText = get.call(box).trim();
    let text = get.call(box);
    if (isNumber(box)) {
      const units = unitsOf(box), value = valueOf(typedText, units);
      if (taken && typedText && !isFinite(value)) refuse(box, typedText, units);
      text = isFinite(value) ? String(Number(value.toPrecision(12))) : "";
    }
    open.delete(box);
    delete box.value;
    if (typed.own) Object.defineProperty(box, "value", typed.own);
    box.value = typed.last;
    if (!taken || (isNumber(box) && text === "")) return;
    set.call(box, text);
    box.dispatchEvent(new Event("input", { bubbles: true }));
  };
  const on = (type, act) => window.addEventListener(type, (event) => {
    const box = event.target;
    if (box.closest && box.matches("input,textarea") && box.closest(BOXES)) act(box, event);
  }, true);
  on("beforeinput", (box, { inputType }) => {
    if (box.tagName !== "INPUT" || inputType !== "insertLineBreak") begin(box);
  });
  on("input", (box, event) => { if (open.has(box)) event.stopImmediatePropagation(); });
  on("keydown", (box, { key }) => {
    if (key === "Escape") end(box, false);
    if (key === "Enter" && box.tagName === "INPUT") end(box, true);
    if (/^Arrow(Up|Down)$/.test(key) && isNumber(box)) end(box, true);
  });
  on("change", (box, event) => { if (open.has(box)) event.stopImmediatePropagation(); });
  on("focusout", (box) => {
    if (!isNumber(box)) return end(box, true);
    if (!open.has(box)) return;
    setTimeout(() => {
      box.focus = () => {}; /* taking a number, it would take the keys back, too */
      end(box, true);
      setTimeout(() => delete box.focus, 50);
    });
  });
}
