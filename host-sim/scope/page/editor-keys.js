// Keys of a scene at a place in its text, by the JSON Schema of scenes: which can be written there, and what a key means.

/** Returns the node of a list's entries, or the node itself. */
const entryOf = (node) => node?.items ?? node;

/** Returns true for a key that has a heading: a table, and at the top also a list of tables. */
const hasHeading = (node, isTop) => (isTop ? entryOf(node) : node)?.properties !== undefined;

/** Returns the node of a key path, such as `['limits', 'band']`, with entries of lists in the place of lists. */
function nodeAt(schema, path) {
  const resolved = (node) => (node?.$ref ? schema.definitions[node.$ref.split('/').pop()] : node);
  let node = schema;
  for (const key of path) node = resolved(entryOf(node?.properties?.[key]));
  return node;
}

/**
 * Returns the place of the caret: `{ path, before, isInline, isInList }`. `path` is that of the table or list around it, and `before` the
 * text from the beginning of its entry. `null` in a comment.
 */
export function placeAt(text, caret) {
  let table = [];
  let open = []; // [bracket, key] of each bracket before the caret that is not closed
  let begin = 0; // of the entry: a line, or what follows a bracket or comma
  let quote = null;
  for (let i = 0; i < caret; i++) {
    const c = text[i];
    if (quote) {
      if (c === '\\' && quote === '"') i++;
      else if (c === quote || c === '\n') quote = null;
      if (c !== '\n') continue;
    }
    const end = text.indexOf('\n', i);
    const line = text.slice(i, end < 0 ? text.length : end);
    const heading = i === begin && open.length === 0 && /^\s*\[\[?\s*([\w.-]+)\s*\]\]?\s*(#.*)?$/.exec(line);
    if (heading && i + line.length < caret) {
      table = heading[1].split('.');
      i += line.length;
      begin = i + 1;
    } else if (c === '#') {
      if (end < 0 || end >= caret) return null;
      i = end - 1;
    } else if (c === '"' || c === "'") {
      quote = c;
    } else if (c === '{' || (c === '[' && (open.length > 0 || /=\s*$/.test(text.slice(begin, i))))) {
      const key = /([\w-]+)\s*=\s*$/.exec(text.slice(begin, i))?.[1];
      open.push([c, key]);
      begin = i + 1;
    } else if (c === '[') {
      // of a heading that is being written
    } else if (c === ']' || c === '}') {
      open.pop();
    } else if (c === ',' && open.length > 0) {
      begin = i + 1;
    } else if (c === '\n' && open.length === 0) {
      begin = i + 1;
    }
  }
  const keys = open.map(([, key]) => key).filter((key) => key !== undefined);
  const bracket = open.at(-1)?.[0];
  return { path: [...table, ...keys], before: text.slice(begin, caret), isInline: bracket === '{', isInList: bracket === '[' };
}

/** Lists the headings of a scene: `{ text, about }`. */
function headings(schema) {
  const found = [];
  const add = (node, path) => {
    for (const [name, property] of Object.entries(node.properties)) {
      if (!hasHeading(property, path === '')) continue;
      const inner = path ? `${path}.${name}` : name;
      found.push({ text: property.items ? `[[${inner}]]` : `[${inner}]`, about: property.description });
      if (!property.items) add(property, inner);
    }
  };
  add(schema, '');
  return found;
}

/**
 * Lists what can be written at the caret: `{ word, choices }`. `word` is what is written of it, and each choice is `{ text, about }`.
 * `null` where the schema knows nothing.
 */
export function choicesAt(schema, text, caret) {
  const place = placeAt(text, caret);
  if (!place) return null;
  const { before, path, isInline, isInList } = place;
  const value = /([\w-]+)\s*=\s*("[\w-]*)$/.exec(before);
  if (value) {
    const words = entryOf(nodeAt(schema, path)?.properties?.[value[1]])?.enum ?? [];
    return matching(value[2], words.map((word) => ({ text: `"${word}"` })));
  }
  if (isInList) return null;
  const heading = isInline ? null : /^\s*(\[+[\w.]*)$/.exec(before);
  if (heading) return matching(heading[1], headings(schema));
  const word = /^\s*([\w-]*)$/.exec(before);
  const properties = Object.entries(nodeAt(schema, path)?.properties ?? {});
  if (!word || properties.length === 0) return null;
  const keys = properties.filter(([, property]) => isInline || !hasHeading(property, path.length === 0));
  return matching(word[1], keys.map(([name, { description }]) => ({ text: name, about: description, isKey: true })));
}

/** Choices that begin with the word, and then those that contain it. */
function matching(word, choices) {
  const plain = (text) => text.replace(/[["]/g, '');
  const wanted = plain(word);
  const begins = choices.filter(({ text }) => plain(text).startsWith(wanted));
  const contains = choices.filter(({ text }) => !plain(text).startsWith(wanted) && plain(text).includes(wanted));
  return { word, choices: [...begins, ...contains].filter(({ text }) => text !== word) };
}

/** Returns what the key at the caret means: `{ key, about }`, with its unit, range and default. `null` if there is none. */
export function meaningAt(schema, text, caret) {
  const end = /^[\w-]*/.exec(text.slice(caret))[0].length;
  const place = placeAt(text, caret + end);
  if (!place) return null;
  const heading = /^\s*\[\[?\s*([\w.-]+)/.exec(place.before);
  if (heading && !place.isInline && !place.isInList) {
    const path = heading[1].split('.');
    const parent = nodeAt(schema, path.slice(0, -1));
    const about = parent?.properties?.[path.at(-1)]?.description;
    return about ? { key: heading[1], about } : null;
  }
  // In a list, the key is that of the list.
  const path = place.isInList ? place.path.slice(0, -1) : place.path;
  const key = place.isInList ? place.path.at(-1) : /^\s*([\w-]+)/.exec(place.before)?.[1];
  const property = nodeAt(schema, path)?.properties?.[key];
  if (!property) return null;
  const usual = property.default === undefined || Array.isArray(property.default) ? '' : `; default ${JSON.stringify(property.default)}`;
  return { key, about: `${property.description}${usual}` };
}
