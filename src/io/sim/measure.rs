//! Queries of the simulated machine from outside the control: positions, wheel, part, events (P2, P5, T3).

use std::f64::consts::PI;

use super::SimulatedMachine;
use super::heat::ContactPower;
use super::magnet::SimMagnet;
use super::part_file::FaceDirection;
use super::report::{PartReport, SimEvent};
use super::spindle::rpm_of;
use super::surface::Surface;
use crate::defs::grinding_workspace::GrindingWorkspace;
use crate::defs::lathe_workspace::LatheWorkspace;
use crate::defs::part_defect::PartDefect;
use crate::units::{MachinePos, PerAxis};

/// Present state of the wheel.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct WheelState {
    /// Mean diameter, mm.
    pub diameter_mm: f64,
    /// Width, mm.
    pub width_mm: f64,
    /// Speed, rpm.
    pub rpm: f64,
    /// Peripheral speed, m/s.
    pub peripheral_m_s: f64,
    /// Rated peripheral speed, m/s.
    pub rated_m_s: f64,
    /// Load of its motor, percent.
    pub load_percent: f64,
    /// Tangential force on the part, N.
    pub tangential_n: f64,
    /// Normal force between wheel and part, N.
    pub normal_n: f64,
    /// Dullness: 0 sharp, 1 dull.
    pub dullness: f64,
}

/// What the process does at a moment, beside the wheel.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ProcessState {
    /// Power that forms chips, W.
    pub chip_w: f64,
    /// Power that ploughs, W.
    pub ploughing_w: f64,
    /// Power that slides, W.
    pub sliding_w: f64,
    /// Amplitude of the wheel's vibration, µm.
    pub vibration_um: f64,
    /// How far the part is warmer than the coolant, K.
    pub part_kelvin: f64,
    /// How far the wheel head has grown towards the part, µm.
    pub head_growth_um: f64,
    /// Wear of the diamond in use, µm.
    pub diamond_wear_um: f64,
    /// What the radial gauge shows above its set size, µm; none with its arm retracted or without a part.
    pub gauge_um: Option<f64>,
}

impl SimulatedMachine {
    /// What the process does at this moment.
    #[must_use]
    pub fn process(&self) -> ProcessState {
        let ContactPower { chip_w, ploughing_w, sliding_w } = self.grinding.power;
        ProcessState {
            chip_w,
            ploughing_w,
            sliding_w,
            vibration_um: self.grinding.vibration.amplitude_um,
            part_kelvin: self.grinding.part_kelvin(),
            head_growth_um: 1_000.0 * self.axis_value(self.file.layout.infeed, |sim| sim.thermal_mm),
            diamond_wear_um: 1_000.0 * self.grinding.diamond_wear_mm(),
            gauge_um: self.gauges.shown_um,
        }
    }

    /// Machine position of each axis at encoder zero, mm; homing must determine it.
    #[must_use]
    pub fn encoder_zero_mm(&self) -> PerAxis<f64> {
        PerAxis::from_fn(|axis| self.axis_value(axis, |sim| sim.encoder_zero_mm))
    }

    /// Actual position of each slide, machine coordinates, mm of slide travel.
    #[must_use]
    pub fn slide_mm(&self) -> MachinePos {
        MachinePos::from_fn(|axis| self.axis_value(axis, |sim| sim.slide_mm))
    }

    /// Present state of the wheel.
    #[must_use]
    pub fn wheel(&self) -> WheelState {
        let ratio = self.internal.as_ref().map_or(1.0, |internal| internal.speed_ratio);
        let (diameter_mm, rpm) = (self.wheel.diameter_mm(), ratio * self.spindles.wheel.rpm);
        WheelState {
            diameter_mm,
            width_mm: self.wheel.width_mm,
            rated_m_s: self.file.wheel.rated_m_s,
            rpm,
            peripheral_m_s: PI * diameter_mm / 1_000.0 * rpm / 60.0,
            load_percent: self.grinding.load_percent,
            tangential_n: self.grinding.tangential_n,
            normal_n: self.grinding.tangential_n / self.file.cutting.force_ratio,
            dullness: self.wheel.rim_dullness,
        }
    }

    /// Wear of each slice of the rim from a new wheel, from the minus side on, mm. Includes dressing and a dressed
    /// profile.
    #[must_use]
    pub fn rim_wear_mm(&self) -> &[f64] {
        &self.wheel.rim_wear_mm
    }

    /// Sets the dullness of the whole wheel, 0 sharp to 1 dull.
    pub fn set_wheel_dullness(&mut self, dull: f64) {
        self.wheel.set_dullness(dull);
    }

    /// Speed of the workhead, rpm; zero where there is none.
    #[must_use]
    pub fn workhead_rpm(&self) -> f64 {
        rpm_of(self.spindles.workhead)
    }

    /// Speed of the rotary table, rpm; zero where there is none.
    #[must_use]
    pub fn table_rpm(&self) -> f64 {
        rpm_of(self.spindles.table)
    }

    /// Speed of the dressing roll, rpm; zero where there is none.
    #[must_use]
    pub fn roll_rpm(&self) -> f64 {
        rpm_of(self.spindles.roll)
    }

    /// Speed of the second spindle, rpm, clockwise positive.
    #[must_use]
    pub const fn second_spindle_rpm(&self) -> f64 {
        self.spindles.second.rpm
    }

    /// Holding force of the magnet, 0 to 1 of its full force; zero where there is none.
    #[must_use]
    pub fn magnet_force(&self) -> f64 {
        self.magnet.as_ref().map_or(0.0, SimMagnet::force)
    }

    /// Which axes exist.
    #[must_use]
    pub fn axes(&self) -> PerAxis<bool> {
        PerAxis::from_fn(|axis| self.axes[axis].is_some())
    }

    /// Hydraulic pressure, MPa.
    #[must_use]
    pub const fn pressure_mpa(&self) -> f64 {
        self.hydraulics.pressure_mpa
    }

    /// Measures the workpiece.
    #[must_use]
    pub fn measure(&self) -> PartReport {
        let mut report = self.measure_bar();
        for (surface, of) in self.grinding.surfaces().iter().enumerate() {
            of.report(&mut report);
            report.roughness.extend(of.finish.report(surface));
        }
        report
    }

    /// Measures each surface of the workpiece by itself, at its ends as well.
    #[must_use]
    pub fn measure_surfaces(&self) -> Vec<PartReport> {
        let measure = |surface: &Surface| {
            let mut report = PartReport::default();
            surface.report(&mut report);
            surface.report_ends(&mut report);
            report
        };
        self.grinding.surfaces().iter().map(measure).collect()
    }

    /// Measures the bar of a lathe; an empty report without one.
    #[must_use]
    pub fn measure_bar(&self) -> PartReport {
        let mut report = PartReport::default();
        if let Some(turning) = &self.lathe {
            turning.report(&mut report);
        }
        report
    }

    /// Diameter of the part at Z, mm; `None` if there is no diameter at Z.
    #[must_use]
    pub fn diameter_at(&self, z: f64) -> Option<f64> {
        let turned = || self.lathe.as_ref().and_then(|turning| turning.diameter_at(z));
        self.grinding.surfaces().iter().find_map(|surface| surface.diameter_at(z)).or_else(turned)
    }

    /// The working area of a grinding machine for the drawing; `None` on a lathe.
    #[must_use]
    pub fn grinding_workspace(&self) -> Option<GrindingWorkspace> {
        let turns = self.lathe.is_some();
        (!turns).then(|| self.grinding.workspace(&self.machine_state(0.0), &self.wheel))
    }

    /// Bar, chuck and tool of a lathe for the drawing; `None` without a bar.
    #[must_use]
    pub fn lathe_workspace(&self) -> Option<LatheWorkspace> {
        self.lathe.as_ref()?.workspace()
    }

    /// Speed of a lathe's main spindle, rpm, forward positive.
    #[must_use]
    pub fn main_spindle_rpm(&self) -> f64 {
        self.lathe.as_ref().map_or(0.0, |turning| turning.rpm)
    }

    /// Z of the first face at X, of the given direction if one is given. X is a diameter on GC, the radius on GA, the
    /// position along X on GS (a wall).
    #[must_use]
    pub fn face_at(&self, x: f64, looks: Option<FaceDirection>) -> Option<f64> {
        self.grinding.surfaces().iter().find_map(|surface| surface.face_at(x, looks))
    }

    /// Height of the part, mm: on GS Y at X and Z, on GA Z at the radius X (`z` is ignored); `None` outside the part.
    #[must_use]
    pub fn height_at(&self, x: f64, z: f64) -> Option<f64> {
        self.grinding.surfaces().iter().find_map(|surface| surface.height_at(x, z))
    }

    /// What has spoilt the part since it was mounted: it is scrap, whatever its size.
    #[must_use]
    pub fn part_defects(&self) -> Vec<PartDefect> {
        self.log.part_defects()
    }

    /// The events so far, oldest first; at most 256.
    #[must_use]
    pub fn events(&self) -> &[SimEvent] {
        &self.log.events
    }
}
