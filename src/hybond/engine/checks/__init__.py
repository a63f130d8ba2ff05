"""Laws put back into themselves: what a run has computed, held against what the model says."""
