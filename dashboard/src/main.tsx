import "uplot/dist/uPlot.min.css";
import "./styles/style.css";
import "./styles/print.css";
import { render } from "preact";
import { connect } from "./data/connection";
import { followAddress } from "./browser/router";
import { findOut } from "./data/session";
import { Shell } from "./shell/shell";
import { followSystem } from "./browser/theme";

followSystem();
followAddress();
connect();
void findOut();
const page = document.getElementById("page")!;
page.replaceChildren();
render(<Shell />, page);
