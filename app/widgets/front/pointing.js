/* Where the pointer is over the scene, while no button is down, and which tab is open: some times a
second, to what is shown only near it. In px from the upper left of the scene. */
if (!window.bohemiaPointer) {
  window.bohemiaPointer = true;
  let waits = null, seen = null, told = "";
  const tab = () => {
    const list = document.querySelector("[role=tablist]");
    return list ? [...list.querySelectorAll("[role=tab]")].findIndex((one) => one.ariaSelected === "true") : 0;
  };
  const tell = () => {
    waits = null;
    const behind = document.querySelector(".bo-pointer");
    const text = `${tab()} ${seen || "- -"}`;
    if (!behind || text === told) return;
    told = text;
    window.bohemiaTell(behind.closest(".bo-live").parentElement.nextElementSibling, text);
  };
  const soon = (wait) => { if (waits === null) waits = setTimeout(tell, wait); };
  window.addEventListener("pointermove", ({ target, clientX, clientY, buttons }) => {
    if (buttons) return;
    const over = target.tagName === "CANVAS" && target.getBoundingClientRect();
    seen = over ? `${Math.round(clientX - over.left)} ${Math.round(clientY - over.top)}` : null;
    soon(100);
  });
  document.documentElement.addEventListener("pointerleave", () => { seen = null; soon(100); });
  window.addEventListener("click", () => soon(0));
  window.addEventListener("keyup", () => soon(0));
}
