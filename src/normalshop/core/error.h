#pragma once

#include <stdexcept>
#include <string>

namespace normalshop {

/// Base of everything that NormalShop throws. The message is one sentence for the user: it names
/// the file, the field and what would be accepted.
class Error : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// A value that the caller gave cannot be used.
class InvalidInput : public Error {
 public:
  using Error::Error;
};

/// A file cannot be read or written.
class IoError : public Error {
 public:
  using Error::Error;
};

/// A document's file cannot be used: damaged, of another kind, too new, or open elsewhere.
class DocumentError : public Error {
 public:
  using Error::Error;
};

/// The user cancelled; nothing has changed.
class Cancelled : public Error {
 public:
  Cancelled() : Error("cancelled") {}
};

}  // namespace normalshop
