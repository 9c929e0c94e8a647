#pragma once

namespace kinship::store::postgres {

/// Ends what waits for a database: once raised, every wait of the connections that were given it
/// ends at once. May be shared between threads.
class Interrupt {
 public:
  /// \throws Failure(Internal) if the system has no descriptor left.
  Interrupt();
  Interrupt(const Interrupt&) = delete;
  Interrupt& operator=(const Interrupt&) = delete;
  ~Interrupt();

  void raise() noexcept;
  bool is_raised() const noexcept;
  int descriptor() const noexcept { return descriptor_; }  ///< readable once it is raised

 private:
  int descriptor_;
};

}  // namespace kinship::store::postgres
