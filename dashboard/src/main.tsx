import "uplot/dist/uPlot.min.css";
import "./style.css";
import "./print.css";
import { render } from "preact";
import { connect } from "./connection";
import { followAddress } from "./router";
import { findOut } from "./session";
import { Shell } from "./shell";
import { followSystem } from "./theme";

followSystem();
followAddress();
connect();
void findOut();
const page = document.getElementById("page")!;
page.replaceChildren();
render(<Shell />, page);
