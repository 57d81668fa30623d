/* The one way from HTML in a panel to the server, as viser reports nothing of what such is told: a
text is written into a hidden box, which viser does report; the time makes every one another text. */
window.bohemiaTell = (behind, text) => {
  const box = behind.querySelector("input");
  const { set } = Object.getOwnPropertyDescriptor(HTMLInputElement.prototype, "value");
  set.call(box, `${text} ${performance.now()}`);
  box.dispatchEvent(new Event("input", { bubbles: true }));
};
/* Elements with data-send tell its text when they are pressed, by mouse or by key. */
if (!window.pressing) {
  const send = (at, text) => {
    if (!at.disabled) window.bohemiaTell(at.closest(".bo-live").parentElement.nextElementSibling, text);
  };
  window.pressing = send;
  window.addEventListener("click", ({ target }) => {
    const at = target.closest && target.closest("[data-send]");
    if (at) send(at, at.dataset.send);
  });
  /* A box with data-write sends that and its text when Enter or leaving it ends what is typed. */
  window.addEventListener("change", ({ target }) => {
    if (target.matches && target.matches("[data-write]")) send(target, `${target.dataset.write} ${target.value}`);
  });
  window.addEventListener("keydown", (event) => {
    const { key, target } = event;
    if (!target.matches || !target.matches("[data-write]")) return;
    if (key === "Escape") target.value = target.defaultValue;
    if (key === "Enter" || key === "Escape") { event.preventDefault(); target.blur(); }
  });
  window.addEventListener("keydown", (event) => {
    const at = event.target;
    if (!at.matches || !at.matches("[data-send]:not(button)")) return;
    if (event.key === "Enter" || event.key === " ") { event.preventDefault(); send(at, at.dataset.send); }
    const step = { ArrowDown: "nextElementSibling", ArrowUp: "previousElementSibling" }[event.key];
    const other = step && at[step];
    if (other && other.matches("[data-send]")) { event.preventDefault(); other.focus(); }
  });
}
/* A box with data-edit sends its number when Enter or leaving it ends what is typed. What is drawn
anew then gets the keys back where they were. */
if (!window.editing) {
  window.editing = true;
  let at = "";
  window.addEventListener("focusin", ({ target }) => {
    at = (target.dataset && target.dataset.edit) || "";
    if (!at) return;
    target.value = target.dataset.whole; /* the box shows but a few digits of it */
    target.select();
  });
  window.addEventListener("focusout", ({ target }) => {
    if (target.dataset && target.dataset.edit && target.value === target.dataset.whole)
      target.value = target.defaultValue;
  });
  window.addEventListener("change", ({ target }) => {
    if (!target.matches || !target.matches("[data-edit]")) return;
    const { line } = target.dataset, many = target.value.trim().split(/[,;\s]+/);
    const row = line ? document.querySelectorAll(`[data-line="${line}"]`).length : 0;
    if (row > 1 && many.length === row && many.every((one) => /^[-+−]?\.?\d/.test(one))) {
      window.pressing(target, `${line} ${target.value.trim()}`); /* of the whole row */
      return;
    }
    const value = window.bohemiaNumber(target, target.dataset.of);
    if (!isFinite(value)) { target.value = target.defaultValue; return; }
    window.pressing(target, `${target.dataset.edit} ${value}`);
  });
  window.addEventListener("keydown", ({ key, target }) => {
    if (!target.matches || !target.matches("[data-edit]")) return;
    if (key === "Escape") { target.value = target.defaultValue; target.blur(); }
    if (key === "Enter") target.blur();
  });
  new MutationObserver(() => {
    if (!at || document.activeElement !== document.body) return;
    const again = document.querySelector(`[data-edit="${at}"]`);
    if (again) again.focus({ preventScroll: true });
  }).observe(document.body, { childList: true, subtree: true });
}
/* The foot opens the explanation of the tab that is open, and the keys below it. */
if (!window.helping) {
  window.helping = true;
  const shut = () => document.querySelectorAll(".bo-help[data-open]").forEach((one) => {
    one.removeAttribute("data-open");
  });
  window.addEventListener("click", ({ target }) => {
    if (!target.closest) return;
    const open = document.querySelector(".bo-help[data-open]");
    if (target.closest(".bo-help")) return;
    shut();
    if (open || !target.closest("[data-help]")) return;
    const here = [...document.querySelectorAll(".bo-help")].filter((one) => one.parentElement.offsetParent).at(-1);
    if (!here) return;
    here.querySelectorAll(".bo-here").forEach((one) => one.remove());
    const keys = document.querySelector(".bo-keys").cloneNode(true);
    keys.hidden = false;
    keys.className = "bo-here";
    here.append(keys);
    here.setAttribute("data-open", "");
  });
  window.addEventListener("keydown", ({ key }) => {
    if (key !== "Escape") return;
    shut();
    const asked = document.querySelector(".bo-ask button"); /* what to click in the scene */
    if (asked) asked.click();
  });
}
