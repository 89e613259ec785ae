// What the user has chosen, kept by this browser. One without storage forgets it.

export function keep(name, value) {
  try {
    localStorage.setItem(`spikeloop.${name}`, value);
  } catch {
    // forgotten with the page
  }
}

/// null: nothing was kept.
export function kept(name) {
  try {
    return localStorage.getItem(`spikeloop.${name}`);
  } catch {
    return null;
  }
}
