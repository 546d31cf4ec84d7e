#pragma once

#include <Message.hxx>
#include <Message_Messenger.hxx>
#include <Standard_Failure.hxx>
#include <mutex>
#include <string>

#include "trimquad/base/error.h"

namespace trimquad {

/// Runs `work`; what OpenCASCADE throws becomes Error(kind, stage, message) with OpenCASCADE's own words
/// appended.
template <class Work>
auto guarded(Error::Kind kind, const std::string& stage, const std::string& message, Work&& work) {
  try {
    return work();
  } catch (const Standard_Failure& failure) {
    std::string text = message;
    const char* said = failure.GetMessageString();
    text += std::string(" (OpenCASCADE: ") + failure.DynamicType()->Name();
    if (said != nullptr && *said != '\0') text += std::string(", ") + said;
    throw Error(kind, stage, text + ")");
  }
}

/// Keeps OpenCASCADE's translators quiet, and to one thread at a time: their settings and their messenger are
/// global to the process, and other code (FreeCAD) has its own printers there, which come back at the end.
class QuietTranslators {
 public:
  QuietTranslators() : lock_(mutex()), printers_(Message::DefaultMessenger()->Printers()) {
    Message::DefaultMessenger()->ChangePrinters().Clear();
  }
  ~QuietTranslators() { Message::DefaultMessenger()->ChangePrinters() = printers_; }
  QuietTranslators(const QuietTranslators&) = delete;
  QuietTranslators& operator=(const QuietTranslators&) = delete;

 private:
  static std::mutex& mutex() {
    static std::mutex instance;
    return instance;
  }
  std::lock_guard<std::mutex> lock_;
  Message_SequenceOfPrinters printers_;
};

}  // namespace trimquad
