#pragma once

/// Makes Ctrl-C (SIGINT) and SIGTERM a request that long work looks at, rather than the end. A second one
/// ends at once.
void catch_interrupts();

/// Whether there was one.
bool interrupted();
