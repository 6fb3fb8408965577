// Light and dark theme. The theme is that of the system until the switch is used.

const KEY = 'cophase-scope-theme';

/** Wires the switch. `changed` is called after the colours have changed. */
export function wireTheme(button, changed) {
  const system = matchMedia('(prefers-color-scheme: dark)');
  const own = () => localStorage.getItem(KEY);
  const show = () => {
    const theme = own() ?? (system.matches ? 'dark' : 'light');
    document.documentElement.dataset.theme = theme;
    const other = theme === 'dark' ? 'light' : 'dark';
    button.textContent = theme === 'dark' ? '☀' : '☾';
    button.setAttribute('aria-label', `Switch to the ${other} theme`);
    button.title = button.getAttribute('aria-label');
    changed();
  };
  button.addEventListener('click', () => {
    localStorage.setItem(KEY, document.documentElement.dataset.theme === 'dark' ? 'light' : 'dark');
    show();
  });
  system.addEventListener('change', show);
  show();
}
