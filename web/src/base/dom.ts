// Elements in one line each.

type Child = Node | string | null;

export function element<K extends keyof HTMLElementTagNameMap>(
  tag: K, className = "", ...children: Child[]
): HTMLElementTagNameMap[K] {
  const node = document.createElement(tag);
  if (className) node.className = className;
  append(node, ...children);
  return node;
}

export function append(node: Element, ...children: Child[]): void {
  for (const child of children) if (child !== null) node.append(child);
}

export function button(text: string, title: string, action: () => void): HTMLButtonElement {
  const node = element("button", "", text);
  node.type = "button";
  node.title = title;
  node.addEventListener("click", action);
  return node;
}

export function section(id: string, title: string, ...children: Child[]): HTMLElement {
  const node = element("section", "", element("h2", "", title), ...children);
  node.id = id;
  return node;
}

/// Buttons of which one is chosen.
export function choice<T extends string>(
  label: string, options: { value: T; text: string }[], chosen: T, action: (value: T) => void
): HTMLElement {
  const group = element("div", "choice");
  group.setAttribute("role", "group");
  group.setAttribute("aria-label", label);
  const buttons = options.map(({ value, text }) => {
    const node = button(text, `${label}: ${text}`, () => {
      for (const other of buttons) other.setAttribute("aria-pressed", String(other === node));
      action(value);
    });
    node.dataset.value = value;
    node.setAttribute("aria-pressed", String(value === chosen));
    return node;
  });
  append(group, ...buttons);
  return group;
}

export function toggle(text: string, checked: boolean, action: (checked: boolean) => void): HTMLElement {
  const box = element("input");
  box.type = "checkbox";
  box.checked = checked;
  box.addEventListener("change", () => action(box.checked));
  return element("label", "toggle", box, text);
}

/// Tells that everything has to be drawn, whether it is in sight or not.
export const kDrawAll = "lodeline-draw-all";

/// Calls once the element comes near the visible part of the page, or the page is printed.
export function whenNear(node: Element, action: () => void): void {
  const call = () => {
    observer.disconnect();
    window.removeEventListener("beforeprint", call);
    window.removeEventListener(kDrawAll, call);
    action();
  };
  const observer = new IntersectionObserver((entries) => {
    if (entries.some((entry) => entry.isIntersecting)) call();
  }, { rootMargin: "300px" });
  observer.observe(node);
  window.addEventListener("beforeprint", call);
  window.addEventListener(kDrawAll, call);
}

/// Calls at once and whenever the element changes its width or height.
export function whenResized(node: Element, action: (width: number, height: number) => void): void {
  new ResizeObserver(() => action(node.clientWidth, node.clientHeight)).observe(node);
}

/// A table that narrow screens show as one block a row, with the heads beside the cells.
export function table(head: (string | Node)[], rows: (string | Node)[][]): HTMLElement {
  const heads = head.map((cell) => element("th", "", cell));
  const lines = rows.map((row) => element("tr", "", ...row.map((cell, i) => {
    const node = element("td", "", cell);
    node.dataset.head = heads[i]?.textContent ?? "";
    return node;
  })));
  return element("div", "scroll",
    element("table", "", element("thead", "", element("tr", "", ...heads)), element("tbody", "", ...lines)));
}
