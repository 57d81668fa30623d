/* What is typed counts when Enter or leaving the box ends it.

viser sends every keystroke, and writes into a box while somebody types in it. So its page hears of
a keystroke only at the end, and what it writes until then is kept aside. Escape gives up what was
typed, and so does leaving a number box without a number in it. Arrow keys step from what was typed.
A number that is left is taken once the box has been: as it is left, viser pulls it back to where
its slider ends. */
if (!window.typedWhenLeft) {
  window.typedWhenLeft = true;
  const open = new WeakMap();
  const BOXES = ".mantine-NumberInput-root,.mantine-TextInput-root,.mantine-Textarea-root";
  const plain = (box) => Object.getOwnPropertyDescriptor(Object.getPrototypeOf(box), "value");
  const isNumber = (box) => box.closest(".mantine-NumberInput-root");
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
    let text = get.call(box);
    if (isNumber(box)) text = text.trim().replace("−", "-").replace(/^(-?\d*),(\d*)$/, "$1.$2");
    open.delete(box);
    delete box.value;
    if (typed.own) Object.defineProperty(box, "value", typed.own);
    box.value = typed.last;
    if (!taken || (isNumber(box) && !(text !== "" && isFinite(text)))) return;
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
