/* A label "x (mm)" stands as a symbol before its row and the unit behind it: style sheets cannot
read texts, so this tells the row its unit. */
if (!window.rows) {
  window.rows = true;
  const mark = () => {
    for (const label of document.querySelectorAll("[data-dock-region=right] .mantine-Flex-root label")) {
      const row = label.closest(".mantine-Flex-root");
      const [, unit] = /^\S{1,3} \((mm|°)\)$/.exec(label.textContent) || [];
      if (unit && row.dataset.unit !== unit) row.dataset.unit = unit;
    }
  };
  let due = 0;
  new MutationObserver(() => {
    if (!due) due = setTimeout(() => { due = 0; mark(); }, 60);
  }).observe(document.body, { childList: true, subtree: true });
  mark();
}
