/* Where the pointer is over the scene, while no button is down, and which tab is open: some times a
second, to what is shown only near it; and where it was pressed without being moved, which nothing
may follow at once: of what is told within 50 ms viser sends the last. In px from the upper left of
the scene. */
if (!window.bohemiaPointer) {
  window.bohemiaPointer = true;
  let waits = null, seen = null, told = "";
  const tab = () => {
    const list = document.querySelector("[role=tablist]");
    return list ? [...list.querySelectorAll("[role=tab]")].findIndex((one) => one.ariaSelected === "true") : 0;
  };
  const tell = (more) => {
    waits = null;
    const behind = document.querySelector(".bo-pointer");
    const text = `${tab()} ${seen || "- -"}`;
    if (!behind || (text === told && !more)) return;
    told = text;
    window.bohemiaTell(behind.closest(".bo-live").parentElement.nextElementSibling, text + more);
  };
  const soon = (wait) => { if (waits === null) waits = setTimeout(tell, wait, ""); };
  const place = ({ target, clientX, clientY }) => {
    const over = target.tagName === "CANVAS" && target.getBoundingClientRect();
    return over ? `${Math.round(clientX - over.left)} ${Math.round(clientY - over.top)}` : null;
  };
  window.addEventListener("pointermove", (event) => {
    if (event.buttons) return;
    seen = place(event);
    soon(100);
  });
  let down = null;
  window.addEventListener("pointerdown", (event) => {
    down = event.button || event.target.tagName !== "CANVAS" ? null : event;
  }, true);
  window.addEventListener("pointerup", (event) => {
    const from = down;
    down = null;
    if (!from || Math.hypot(event.clientX - from.clientX, event.clientY - from.clientY) > 4) return;
    seen = place(from);
    clearTimeout(waits);
    tell(" pressed");
    waits = setTimeout(tell, 200, "");
  }, true);
  document.documentElement.addEventListener("pointerleave", () => { seen = null; soon(100); });
  window.addEventListener("click", () => soon(0));
  window.addEventListener("keyup", () => soon(0));
}
