// Several viewers on a page that follow each other: the way one looks, the shape, the colours and their range.

/** What the viewers of a page have in common while they are linked; more than one is needed to matter. */
export function linking() {
  const members = [];
  let linked = true;
  let busy = false;

  function others(self, each) {
    if (!linked || busy) return;
    busy = true;
    for (const member of members) if (member !== self) each(member);
    busy = false;
  }

  return {
    join(member) { members.push(member); },
    get linked() { return linked; },
    set linked(on) {
      linked = on;
      for (const member of members) member.refresh();
    },
    turned(self, pose) { others(self, (member) => member.follow(pose)); },
    changed(self, asked) { others(self, (member) => member.askNamed(asked)); },
    /** The colours of the range that holds for all members that can tell the quantity; the extent is one's own. */
    range(self, own, key, robust, steady, poseName) {
      if (!own || !linked || members.length < 2) return own;
      const all = members.map((member) => member === self ? own : member.ownRange(key, robust, steady, poseName)).filter(Boolean);
      const low = Math.min(...all.map((one) => one.low));
      const high = Math.max(...all.map((one) => one.high));
      if (!self.quantity(key).signed || low === 0 || high === 0) return { ...own, low, high };
      const reach = Math.max(-low, high);
      return { ...own, low: -reach, high: reach };
    },
    /** The factors by which moves can be enlarged in all members alike. */
    factors(self, reference) {
      const all = linked && members.length > 1 ? members : [self];
      return all.map((member) => member.ownFactors(reference)).reduce((a, b) => (b.length < a.length ? b : a));
    },
    refresh(self) { others(self, (member) => member.refresh()); },
  };
}
