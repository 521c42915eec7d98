// Nothing builds this one.
