// SPDX-License-Identifier: MIT
#pragma once

namespace gnomon::test {

/**
 * Replaces one of epoxy's function pointers until it is destroyed. The function must have been called before, because
 * the first call sets the pointer.
 */
template <typename Function>
class Hook {
 public:
  Hook(Function &target, Function replacement) : target_(target), original_(target)
  {
    target_ = replacement;
  }
  Hook(const Hook &) = delete;
  Hook &operator=(const Hook &) = delete;
  ~Hook()
  {
    target_ = original_;
  }

 private:
  Function &target_;
  Function original_;
};

}  // namespace gnomon::test
