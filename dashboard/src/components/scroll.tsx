// A table that may be wider than the page: it scrolls by itself, and keys reach it where it does.
import type { ComponentChildren } from "preact";
import { useEffect, useRef, useState } from "preact/hooks";
import { t } from "../messages/messages";

export function Scroll({ label, children }: { label: string; children: ComponentChildren }) {
  const box = useRef<HTMLDivElement>(null);
  const [wide, setWide] = useState(false);
  useEffect(() => {
    const whole = box.current!;
    const observer = new ResizeObserver(() => setWide(whole.scrollWidth > whole.clientWidth + 1));
    observer.observe(whole);
    for (const one of whole.children) observer.observe(one);
    return () => observer.disconnect();
  }, []);
  return (
    <div class="scroll" ref={box} {...(wide ? { tabIndex: 0, role: "group", "aria-label": t("scrollsSideways", { label }) } : {})}>
      {children}
    </div>
  );
}
