#pragma once

namespace mvtp {

inline constexpr double kLineGap = 1.0;  ///< [m] before a line where drivers stop

/// The speed from which one can stop behind a leader that brakes as hard [Krauss 1998].
[[nodiscard]] double safe_speed(double room, double leader, double decel, double reaction);
/// How far one drives while braking to rest [m].
[[nodiscard]] double stopping(double v, double decel);

}  // namespace mvtp
