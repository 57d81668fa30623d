/* What of the panel's texts is cut or lies over one another: a list of sentences. */
() => {
  const found = [], seen = [];
  const shown = (node) => {
    for (let at = node; at && at !== document.body; at = at.parentElement) {
      if (at.className.includes && at.className.includes("Tooltip")) return false;
      const style = getComputedStyle(at);
      if (style.visibility === "hidden" || style.display === "none" || style.opacity === "0")
        return false;
      if (style.clipPath !== "none") return false;
    }
    return true;
  };
  const clip = (node) => {
    const box = { left: 0, top: 0, right: innerWidth, bottom: innerHeight };
    let cutter = null;
    for (let at = node; at && at !== document.body; at = at.parentElement) {
      const style = getComputedStyle(at);
      if (style.position === "fixed" && at !== node) break; /* nothing around it cuts it */
      if (style.overflowX === "visible" && style.overflowY === "visible") continue;
      const rect = at.getBoundingClientRect();
      if (rect.right < box.right - 0.5) { box.right = rect.right; cutter = at; }
      box.left = Math.max(box.left, rect.left);
      if (style.overflowY !== "visible") {
        box.top = Math.max(box.top, rect.top);
        box.bottom = Math.min(box.bottom, rect.bottom);
      }
    }
    return { ...box, cutter };
  };
  const panel = document.querySelector(".bo-status").closest(".mantine-ScrollArea-viewport");
  const texts = document.createTreeWalker(document.body, NodeFilter.SHOW_TEXT);
  while (texts.nextNode()) {
    const node = texts.currentNode, parent = node.parentElement;
    const text = node.textContent.trim();
    if (!text || parent.closest("script,style,canvas,title,option,[role=tooltip]")) continue;
    if (parent.closest("details:not([open])") && !parent.closest("summary")) continue;
    if (!shown(parent)) continue;
    const look = getComputedStyle(parent);
    if (look.textOverflow === "ellipsis" && parent.closest("[title]")) continue; /* told whole */
    const box = clip(parent);
    const range = document.createRange();
    range.selectNodeContents(node);
    for (const rect of range.getClientRects()) {
      if (rect.width < 1 || rect.height < 1) continue;
      if (rect.bottom <= box.top + 2 || rect.top >= box.bottom - 2) continue; /* scrolled away */
      if (rect.right > box.right + 1.5 || rect.left < box.left - 1.5)
        found.push(`cut: ${text.slice(0, 50)} (${Math.round(rect.left)}–${Math.round(rect.right)}`
          + ` of ${Math.round(box.left)}–${Math.round(box.right)})`);
      seen.push({ node, text, rect, parent, top: Math.max(rect.top, box.top),
        bottom: Math.min(rect.bottom, box.bottom) });
    }
  }
  for (const input of document.querySelectorAll("input[type=text],input:not([type])")) {
    if (!shown(input) || !input.getBoundingClientRect().width || input === document.activeElement)
      continue;
    if (input.scrollWidth > input.clientWidth + 1)
      found.push(`cut in its box: ${input.value.slice(0, 40)}`);
  }
  const bar = panel && panel.parentElement.querySelector("[data-orientation=vertical]");
  seen.sort((a, b) => a.top - b.top);
  seen.forEach((one, n) => {
    for (const other of seen.slice(n + 1)) {
      if (other.top > one.bottom - 3) break;
      const wide = Math.min(one.rect.right, other.rect.right)
        - Math.max(one.rect.left, other.rect.left);
      const high = Math.min(one.bottom, other.bottom) - Math.max(one.top, other.top);
      const sticky = [one, other].some((each) => each.parent.closest(".bo-help"));
      if (wide > 2 && high > 3 && !sticky && one.node !== other.node)
        found.push(`over one another: ${one.text.slice(0, 30)} / ${other.text.slice(0, 30)}`);
    }
    if (bar && bar.getBoundingClientRect().width) {
      const edge = bar.getBoundingClientRect();
      if (one.rect.right > edge.left + 1 && one.rect.left < edge.right && one.bottom > edge.top
        && one.parent.closest(".mantine-ScrollArea-viewport") === panel)
        found.push(`under the scroll bar: ${one.text.slice(0, 40)}`);
    }
  });
  return [...new Set(found)];
}
