// Elements from a template.

/** Fills an element from HTML, and returns the elements that have `data-part`, by that name. */
export function html(element, className, template) {
  element.classList.add(className);
  element.innerHTML = template;
  const parts = element.querySelectorAll('[data-part]');
  return Object.fromEntries([...parts].map((part) => [part.dataset.part, part]));
}

/** Makes an SVG element with attributes and children. */
export function svg(name, attributes = {}, ...children) {
  const element = document.createElementNS('http://www.w3.org/2000/svg', name);
  for (const [key, value] of Object.entries(attributes)) element.setAttribute(key, value);
  element.append(...children);
  return element;
}
