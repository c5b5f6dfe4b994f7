// SPDX-License-Identifier: GPL-3.0-or-later
#include "PixelModule.h"

#include <dcmtk/config/osconfig.h>
#include <dcmtk/dcmdata/dctk.h>
#include <dcmtk/oflog/oflog.h>

#include <memory>

#include "FrameSpecFrom.h"
#include "vernier/base/Guarded.h"

namespace vernier {
namespace {

// DCMTK writes its opinion of bad values to stderr, where a program's one sentence stands.
void silenceDcmtk() {
  static const bool silent = (OFLog::configure(OFLogger::OFF_LOG_LEVEL), true);
  (void)silent;
}

// newDicomElementWithVR() and tags with their VR: anything else would load DCMTK's dictionary, 50 ms for each
// program. The element as it stands in the file: its VR is kept, so that frameSpecFrom() sees a lie.
void copyTo(DcmItem& item, const Header& h, const Element& e, DcmEVR expected) {
  const char vrText[3] = {e.vr[0], e.vr[1], 0};
  DcmEVR vr = e.vr[0] == ' ' ? expected : DcmVR(vrText).getEVR();
  // Any other binary VR is a lie about these attributes, and one kind of lie stands for all.
  const bool text = vr == EVR_UI || vr == EVR_IS || vr == EVR_DS || vr == EVR_CS || vr == EVR_LO ||
                    vr == EVR_SH || vr == EVR_LT || vr == EVR_ST || vr == EVR_UT || vr == EVR_DA ||
                    vr == EVR_TM || vr == EVR_AE;
  if (!text && vr != EVR_US && vr != EVR_SS && vr != EVR_UN) vr = EVR_UL;
  const DcmTag tag(static_cast<Uint16>(e.tag >> 16), static_cast<Uint16>(e.tag & 0xFFFF), DcmVR(vr));
  DcmElement* element = nullptr;
  if (DcmItem::newDicomElementWithVR(element, tag).bad() || !element) return;
  std::unique_ptr<DcmElement> owner(element);
  if (vr == EVR_US || vr == EVR_SS) {
    std::vector<Uint16> words;
    for (std::size_t n = 0; n < e.length / 2 && n < 16; ++n) words.push_back(*word(h, e, n));
    if (vr == EVR_US)
      element->putUint16Array(words.data(), static_cast<unsigned long>(words.size()));
    else
      element->putSint16Array(reinterpret_cast<const Sint16*>(words.data()),
                              static_cast<unsigned long>(words.size()));
  } else if (vr == EVR_UL) {
    const Uint32 any = 0;  // the value is of no use: the VR is refused
    element->putUint32Array(&any, 1);
  } else if (text) {
    element->putString(std::string(rawText(h, e)).c_str());
  } else {
    const auto v = h.value(e);
    element->putUint8Array(reinterpret_cast<const Uint8*>(v.data()), static_cast<unsigned long>(v.size()));
  }
  if (item.insert(element, OFTrue).good()) owner.release();
}

struct Wanted {
  Tag tag;
  DcmEVR vr;
};
constexpr Wanted kPixelModule[] = {{0x00080016, EVR_UI}, {0x00280002, EVR_US}, {0x00280004, EVR_CS},
                                   {0x00280006, EVR_US}, {0x00280008, EVR_IS}, {0x00280010, EVR_US},
                                   {0x00280011, EVR_US}, {0x00280100, EVR_US}, {0x00280101, EVR_US},
                                   {0x00280102, EVR_US}, {0x00280103, EVR_US}};

}  // namespace

Result<FrameSpec> frameSpecOf(const Header& h) {
  return guarded("frameSpecOf", [&]() -> Result<FrameSpec> {
    silenceDcmtk();
    DcmItem item;
    for (const Wanted& w : kPixelModule)
      if (const Element* e = h.find(w.tag); e && e->length <= 1024) copyTo(item, h, *e, w.vr);
    if (h.pixels && (h.pixels->element.tag & 0xFFFF) != 0x0010) {
      const bool isFloat = (h.pixels->element.tag & 0xFFFF) == 0x0008;
      DcmElement* e = nullptr;
      const DcmTag tag(0x7FE0, isFloat ? 0x0008 : 0x0009, DcmVR(isFloat ? EVR_OF : EVR_OD));
      if (DcmItem::newDicomElementWithVR(e, tag).good() && e) item.insert(e, OFTrue);
    }
    // Without a meta header the syntax is what was found.
    std::string syntax = h.transferSyntaxUid;
    if (syntax.empty())
      syntax = !h.encoding.explicitVr ? "1.2.840.10008.1.2"
               : h.encoding.bigEndian ? "1.2.840.10008.1.2.2"
                                      : "1.2.840.10008.1.2.1";
    return frameSpecFrom(item, syntax);
  });
}

}  // namespace vernier
