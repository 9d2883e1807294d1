#pragma once

namespace mvtp {

/// From now on SIGINT and SIGTERM are noted instead of ending the process; a second one ends it at
/// once, with exit code 130.
void note_interrupts();

/// Has one of them come? Cheap: for loops of any kind.
[[nodiscard]] bool interrupted();

}  // namespace mvtp
