#pragma once

namespace trimquad {

/// While one lives, memory that is freed stays with the process, for the next that asks for it. The stages
/// take and free hundreds of megabytes again and again, and the system's zeroed pages cost them a third of
/// their time otherwise. After the last one, what is free goes back to the system. Nothing but a hint: it
/// does nothing where the C library is not GNU's.
class KeptMemory {
 public:
  KeptMemory();
  ~KeptMemory();
  KeptMemory(const KeptMemory&) = delete;
  KeptMemory& operator=(const KeptMemory&) = delete;
};

}  // namespace trimquad
